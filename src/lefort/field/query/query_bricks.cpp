#include <lefort/core/check.h>
#include <lefort/field/internal/distances_avx512.h>
#include <lefort/field/internal/pack.h>
#include <lefort/field/query/query_bricks.h>
#include <lefort/field/query/trilinear.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <type_traits>

namespace lefort::field {

namespace {

/// Points per group: enough to hide memory latency, few enough for the first-level cache.
constexpr std::size_t kGroup = 32;
/// Fewer points are not sorted.
constexpr std::size_t kMinPointsToSort = 128;
constexpr std::size_t kLanes = 16;
constexpr std::size_t kCorners = 8;

template <class Real, Simd simd>
using Lanes = internal::Pack<Real, kLanes, simd>;

/// Constants of a lookup.
struct Lookup {
  const Brick* bricks;
  const std::byte* codes;
  std::int32_t side;  ///< Bricks along an edge of the table.
  std::int32_t last_cell;
  double maximum;  ///< Cells along an edge of the cube.
  double cells_per_mm;
  /// x, y, z of the origin of the cube, repeated: positions are processed as one row of numbers.
  std::array<double, 3 * kGroup> origin;

  Lookup(const BrickSamples& samples, const FieldFrame& frame)
      : bricks(samples.bricks().data()),
        codes(samples.codes().data()),
        side(SparseLattice::bricks_per_side(samples.resolution())),
        last_cell(frame.resolution - 1),
        maximum(frame.resolution),
        cells_per_mm(1.0 / frame.cell_mm) {
    for (std::size_t i = 0; i < origin.size(); ++i) origin[i] = frame.origin_B[Index(i % 3)];
  }
};

/// The points of a group between the three stages.
template <class Real>
struct Group {
  std::array<std::int32_t, 3 * kGroup> cell;
  std::array<Real, 3 * kGroup> t;  ///< Positions in the cells.
  /// -1 inside the cube; 0 outside, or if not finite.
  std::array<std::int32_t, 3 * kGroup> within;
  std::array<const std::byte*, kCorners * kGroup> corners;  ///< Addresses of codes, by point.
};

LEFORT_INLINE void prefetch(const void* address) { __builtin_prefetch(address); }

/// Stage 1: finds the cells.
///
/// \param p  x, y, z of the points of a group, one after another.
template <class Real>
LEFORT_INLINE void locate(const Lookup& lookup, const double* p, Group<Real>& group) {
  for (std::size_t i = 0; i < 3 * kGroup; ++i) {
    const double u = (p[i] - lookup.origin[i]) * lookup.cells_per_mm;
    const bool within = u >= 0.0 && u <= lookup.maximum;  // False for NaN.
    const std::int32_t cell = std::min(std::int32_t(within ? u : 0.0), lookup.last_cell);
    group.within[i] = within ? -1 : 0;
    group.cell[i] = cell;
    group.t[i] = Real(u - cell);
  }
  for (std::size_t n = 0; n < kGroup; ++n) {
    const std::int32_t* const c = group.cell.data() + 3 * n;
    prefetch(lookup.bricks + ((c[2] / 8 + 1) * lookup.side + c[1] / 8 + 1) * lookup.side +
             c[0] / 8 + 1);
  }
}

/// Contribution of one coordinate to the number of a brick, of a leaf, and to the offset in a leaf.
struct AxisOffset {
  std::int32_t brick;
  std::uint32_t leaf;
  std::uint32_t offset;

  LEFORT_INLINE AxisOffset(std::int32_t coordinate, std::int32_t brick_stride, unsigned axis) {
    const auto c = std::uint32_t(coordinate);
    brick = std::int32_t(c / 8U + 1U) * brick_stride;
    leaf = (c >> 2 & 1U) << axis;
    offset = (c & 3U) * (std::uint32_t(BrickSamples::kCodeBytes) << (2U * axis));
  }
};

/// Replaces leaves that are not stored; it has no distances, so its points take the slow path.
constexpr auto kNoLeaf = [] {
  std::array<std::byte, BrickSamples::kLeafBytes + 1> leaf{};
  for (std::size_t i = 2; i < leaf.size(); i += BrickSamples::kCodeBytes) leaf[i] = std::byte(0x80);
  return leaf;
}();

/// Stage 2: finds the samples. Seven of twelve cells have corners in several leaves, which branch
/// prediction cannot learn; so there is a branch along x only, where it pays.
LEFORT_INLINE void find_corners(const Lookup& lookup, const std::int32_t* cells,
                                const std::byte** corners) {
  static_assert(SparseLattice::kSide == 8 && BrickSamples::kLeafSide == 4);
  const std::int32_t row = lookup.side, slice = lookup.side * lookup.side;
  const Brick* const bricks = lookup.bricks;
  const std::byte* const codes = lookup.codes;
  for (std::size_t n = 0; n < kGroup; ++n, cells += 3, corners += kCorners) {
    const AxisOffset x(cells[0], 1, 0), y0(cells[1], row, 1), y1(cells[1] + 1, row, 1),
        z0(cells[2], slice, 2), z1(cells[2] + 1, slice, 2);
    const std::array<std::int32_t, 4> brick = {y0.brick + z0.brick, y1.brick + z0.brick,
                                               y0.brick + z1.brick, y1.brick + z1.brick};
    const std::array<std::uint32_t, 4> leaf = {y0.leaf | z0.leaf, y1.leaf | z0.leaf,
                                               y0.leaf | z1.leaf, y1.leaf | z1.leaf};
    const std::array<std::uint32_t, 4> offset = {y0.offset + z0.offset, y1.offset + z0.offset,
                                                 y0.offset + z1.offset, y1.offset + z1.offset};
    const auto code_address = [&](std::size_t i, const AxisOffset& at)
        __attribute__((always_inline)) {
      const Brick& found = bricks[brick[i] + at.brick];
      const std::uint32_t which = leaf[i] | at.leaf, stored = found.stored;
      const std::size_t position =
          found.first_leaf + std::size_t(std::popcount(stored & ((1U << which) - 1U)));
      const std::byte* const first = (stored >> which & 1U) != 0
                                         ? codes + position * BrickSamples::kLeafBytes
                                         : kNoLeaf.data();
      return first + (offset[i] + at.offset);
    };
    for (std::size_t i = 0; i < 4; ++i) {
      corners[2 * i] = code_address(i, x);
      prefetch(corners[2 * i]);
    }
    if ((cells[0] & 3) != 3) {
      for (std::size_t i = 0; i < 4; ++i)
        corners[2 * i + 1] = corners[2 * i] + BrickSamples::kCodeBytes;
    } else {
      const AxisOffset next(cells[0] + 1, 1, 0);
      for (std::size_t i = 0; i < 4; ++i) {
        corners[2 * i + 1] = code_address(i, next);
        prefetch(corners[2 * i + 1]);
      }
    }
  }
}

using FindCorners = void(const Lookup&, const std::int32_t*, const std::byte**);

// Not inlined: among vectors the compiler keeps addresses in the wrong registers.
[[gnu::noinline]] void find_corners_baseline(const Lookup& lookup, const std::int32_t* cells,
                                             const std::byte** corners) {
  find_corners(lookup, cells, corners);
}

#if defined(__x86_64__)
[[gnu::noinline]] __attribute__((target("popcnt,bmi,bmi2"))) void find_corners_popcnt(
    const Lookup& lookup, const std::int32_t* cells, const std::byte** corners) {
  find_corners(lookup, cells, corners);
}
#endif

/// Samples and positions of sixteen points, by lane.
template <class Real, Simd simd>
struct Cells {
  std::array<Lanes<Real, simd>, kCorners> corners;  ///< In units of the quantum.
  std::array<Lanes<Real, simd>, 3> t;
  std::array<std::int32_t, kLanes> is_known;  ///< Not zero if all corners are distances.
};

/// Numbers of three bytes from words of four.
template <Simd simd>
LEFORT_INLINE Lanes<std::int32_t, simd> sign_extended(const Lanes<std::int32_t, simd>& words) {
  return Lanes<std::int32_t, simd>::of([&](std::size_t n) __attribute__((always_inline)) {
    return words.parts[n] << 8 >> 8;
  });
}

/// The same numbers in double precision; they are stored and loaded, because their registers hold
/// half as many.
template <Simd simd>
LEFORT_INLINE Lanes<double, simd> widened(const Lanes<float, simd>& values) {
  using Doubles = Lanes<double, simd>;
  using Half = internal::Pack<float, Doubles::kPartLanes, simd>;
  alignas(64) std::array<float, kLanes> stored;
  values.store(stored.data());
  return Doubles::of([&](std::size_t n) __attribute__((always_inline)) {
    return __builtin_convertvector(Half::loaded(&stored[n * Doubles::kPartLanes]).parts[0],
                                   typename Doubles::Register);
  });
}

/// Stage 3: reads the samples.
template <class Real, Simd simd>
LEFORT_INLINE void read_cells(const Group<Real>& group, std::size_t first,
                              Cells<Real, simd>& cells) {
  using Ints = Lanes<std::int32_t, simd>;
  using Floats = Lanes<float, simd>;
  alignas(64) std::array<std::array<std::int32_t, kLanes>, kCorners> codes;
  alignas(64) std::array<std::array<Real, kLanes>, 3> t;
  alignas(64) std::array<std::int32_t, kLanes> within;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const std::size_t n = first + l;
    for (std::size_t corner = 0; corner < kCorners; ++corner)
      std::memcpy(&codes[corner][l], group.corners[kCorners * n + corner], sizeof(std::int32_t));
    for (std::size_t k = 0; k < 3; ++k) t[k][l] = group.t[3 * n + k];
    within[l] = group.within[3 * n] & group.within[3 * n + 1] & group.within[3 * n + 2];
  }
  auto largest = Floats::filled(0.0F);  // Of the magnitudes, which single precision represents.
  for (std::size_t corner = 0; corner < kCorners; ++corner) {
    // The fourth byte belongs to another sample.
    const Ints code = sign_extended(Ints::loaded(codes[corner].data()));
    const Floats value = Floats::converted(code);
    largest = larger(larger(value, -value), largest);
    if constexpr (std::is_same_v<Real, float>) {
      cells.corners[corner] = value;
    } else {
      cells.corners[corner] = widened<simd>(value);
    }
  }
  const Ints known = select(largest < Floats::filled(float(BrickSamples::kBeyond)),
                            Ints::loaded(within.data()), Ints::filled(0));
  known.store(cells.is_known.data());
  for (std::size_t k = 0; k < 3; ++k) cells.t[k] = Lanes<Real, simd>::loaded(t[k].data());
}

/// Zone of a point without a distance.
template <class Real>
Zone zone_at(const BrickSamples& samples, const FieldFrame& frame, const Vec3& p_B,
             const Group<Real>& group, std::size_t n) {
  const std::int32_t* const within = group.within.data() + 3 * n;
  if ((within[0] & within[1] & within[2]) == 0) return zone_beyond_box(frame, p_B);
  const std::int32_t* const c = group.cell.data() + 3 * n;
  std::array<float, kCorners> corners;
  for (int i = 0; i < int(kCorners); ++i)
    corners[std::size_t(i)] = samples.distance_of(BrickSamples::read_code(
        samples.code_address({c[0] + (i & 1), c[1] + (i >> 1 & 1), c[2] + (i >> 2)})));
  return zone_of(corners);
}

/// Calls finish(first, count, cells, group, position) for all points, at most kLanes at a time:
/// `first` is the position among the points, `position` that in the group.
template <class Real, Simd simd, class Finish>
LEFORT_INLINE void for_all(const BrickSamples& samples, const FieldFrame& frame,
                           std::span<const Vec3> p_B, FindCorners find_corners_of,
                           const Finish& finish) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const Lookup lookup(samples, frame);
  Group<Real> group;
  Cells<Real, simd> cells;
  std::array<Vec3, kGroup> last;
  for (std::size_t begin = 0; begin < p_B.size(); begin += kGroup) {
    const std::size_t count = std::min(kGroup, p_B.size() - begin);
    const double* p = p_B.data()[begin].data();
    if (count < kGroup) {
      last.fill(p_B[begin]);
      std::copy_n(p_B.begin() + std::ptrdiff_t(begin), count, last.begin());
      p = last.data()->data();
    }
    locate(lookup, p, group);
    find_corners_of(lookup, group.cell.data(), group.corners.data());
    for (std::size_t position = 0; position < count; position += kLanes) {
      read_cells(group, position, cells);
      finish(begin + position, std::min(kLanes, count - position), cells, group, position);
    }
  }
}

struct Query {
  const BrickSamples& samples;
  const FieldFrame& frame;
  std::span<const Vec3> p_B;
  FindCorners* find_corners;
};

template <Simd simd>
LEFORT_INLINE void sample_all(const Query& query, std::span<FieldSample> results) {
  // Double precision, because solvers use differences of these values.
  const double quantum_mm = double(query.samples.quantum_mm());
  const double slope = quantum_mm / query.frame.cell_mm;
  for_all<double, simd>(
      query.samples, query.frame, query.p_B, *query.find_corners,
      [&](std::size_t first, std::size_t count, const Cells<double, simd>& cells,
          const Group<double>& group, std::size_t position) __attribute__((always_inline)) {
        alignas(64) std::array<double, kLanes> distance, x, y, z;
        (trilinear(cells.corners, cells.t) * quantum_mm).store(distance.data());
        const auto gradient = trilinear_gradient(cells.corners, cells.t);
        (gradient[0] * slope).store(x.data());
        (gradient[1] * slope).store(y.data());
        (gradient[2] * slope).store(z.data());
        for (std::size_t l = 0; l < count; ++l) {
          if (cells.is_known[l] == 0) [[unlikely]] {
            results[first + l] = beyond_band(
                zone_at(query.samples, query.frame, query.p_B[first + l], group, position + l),
                query.frame.band_mm);
          } else {
            results[first + l] = {Zone::kBand, distance[l], Vec3(x[l], y[l], z[l])};
          }
        }
      });
}

template <Simd simd>
LEFORT_INLINE void distances_all(const Query& query, std::span<float> distances_mm) {
  const float quantum_mm = query.samples.quantum_mm();
  for_all<float, simd>(
      query.samples, query.frame, query.p_B, *query.find_corners,
      [&](std::size_t first, std::size_t count, const Cells<float, simd>& cells,
          const Group<float>& group, std::size_t position) __attribute__((always_inline)) {
        alignas(64) std::array<float, kLanes> distance;
        (trilinear(cells.corners, cells.t) * quantum_mm).store(distance.data());
        for (std::size_t l = 0; l < count; ++l)
          distances_mm[first + l] =
              cells.is_known[l] != 0
                  ? distance[l]
                  : zone_value(zone_at(query.samples, query.frame, query.p_B[first + l], group,
                                       position + l));
      });
}

#if defined(__x86_64__)
LEFORT_AVX512 void sample_avx512(const Query& query, std::span<FieldSample> results) {
  sample_all<Simd::kAvx512>(query, results);
}
LEFORT_AVX2 void sample_avx2(const Query& query, std::span<FieldSample> results) {
  sample_all<Simd::kAvx2>(query, results);
}
LEFORT_AVX512 void distances_avx512(const Query& query, std::span<float> distances_mm) {
  distances_all<Simd::kAvx512>(query, distances_mm);
}
LEFORT_AVX2 void distances_avx2(const Query& query, std::span<float> distances_mm) {
  distances_all<Simd::kAvx2>(query, distances_mm);
}
#endif

}  // namespace

void sample_bricks(const BrickSamples& samples, const FieldFrame& frame, std::span<const Vec3> p_B,
                   std::span<FieldSample> results, Simd simd) {
  LEFORT_CHECK(p_B.size() == results.size());
  Query query{samples, frame, p_B, find_corners_baseline};
#if defined(__x86_64__)
  if (simd != Simd::kBaseline) query.find_corners = find_corners_popcnt;
  if (simd == Simd::kAvx512) return sample_avx512(query, results);
  if (simd == Simd::kAvx2) return sample_avx2(query, results);
#endif
  sample_all<Simd::kBaseline>(query, results);
}

void distances_in_bricks(const BrickSamples& samples, const FieldFrame& frame,
                         std::span<const Vec3> p_B, std::span<float> distances_mm, Simd simd) {
  LEFORT_CHECK(p_B.size() == distances_mm.size());
  Query query{samples, frame, p_B, find_corners_baseline};
#if defined(__x86_64__)
  if (simd != Simd::kBaseline) query.find_corners = find_corners_popcnt;
  if (simd == Simd::kAvx512 && p_B.size() >= kMinPointsToSort && internal::fits_avx512(samples))
    return internal::distances_avx512(samples, frame, p_B, distances_mm);
  if (simd == Simd::kAvx512) return distances_avx512(query, distances_mm);
  if (simd == Simd::kAvx2) return distances_avx2(query, distances_mm);
#endif
  distances_all<Simd::kBaseline>(query, distances_mm);
}

}  // namespace lefort::field
