#include <lefort/field/internal/distances_avx512.h>
#include <lefort/field/internal/simd.h>

#if defined(__x86_64__)

#include <lefort/core/check.h>
#include <lefort/field/field_sample.h>
#include <lefort/field/query/cell_samples.h>
#include <lefort/field/query/trilinear.h>
#include <lefort/field/zone.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

// Addresses are computed in vectors, so memory reads dominate, and there are as few as possible.
// The two corners of a cell along x are adjacent unless a leaf ends between them: one read gets
// both. All corners are in one brick unless a brick ends in the cell: one table entry instead of
// eight. In sixteen points there would nearly always be exceptions, so points are first sorted by
// kind.

namespace lefort::field::internal {

namespace {

#define LEFORT_TARGET "avx512f,avx512vl,avx512bw,avx512dq,popcnt,prefer-vector-width=512"
#define LEFORT_STEP inline __attribute__((always_inline, target(LEFORT_TARGET)))

constexpr std::size_t kLanes = 16;
/// Points per group: many, so that few lanes are empty; few enough for the first-level cache.
constexpr std::size_t kGroup = 512;
constexpr std::size_t kCorners = 8;
/// Points whose codes are read together: few enough that codes are still cached when they are used.
constexpr std::size_t kChunk = 32;
/// Second-level cache of most cores; prefetching costs more than it saves if all samples fit.
constexpr std::size_t kCacheBytes = 2 << 20;
constexpr int kAll = 0xFFFF;
constexpr std::size_t kLineBytes = 64;  ///< Of a cache line.
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));

struct Lookup {
  const Brick* bricks;
  const std::byte* codes;
  int side;
  int last_cell;
  bool fetch;  ///< Samples do not fit into the cache of one core.
  double maximum;
  double cells_per_mm;
  std::array<double, 24> origin;  ///< x, y, z, repeated.
};

/// Bits of a cell coordinate.
constexpr unsigned kCellBits = 11;
constexpr int kMaxCells = 1 << kCellBits;
static_assert(kGroup <= std::size_t(1) << (32 - 2 * kCellBits));
// For alignment.
static_assert(kGroup % kLanes == 0 && kGroup % kChunk == 0 && kChunk % kLanes == 0);

/// Points of one kind.
struct Points {
  std::size_t count = 0;
  // Padded by one vector.
  using Row = std::array<std::int32_t, kGroup + kLanes>;
  alignas(64) Row number_yx;  ///< Number in the group, then y and x of the cell, kCellBits each.
  alignas(64) Row z;          ///< Of the cell.
  alignas(64) std::array<std::array<float, kGroup + kLanes>, 3> t;
};

/// Transposes sixteen triples to vectors of x, y and z.
LEFORT_STEP void by_axis(const __m512i& a, const __m512i& b, const __m512i& c,
                         std::array<__m512i, 3>& axes) {
  const __m512i lanes =
      _mm512_set_epi32(45, 42, 39, 36, 33, 30, 27, 24, 21, 18, 15, 12, 9, 6, 3, 0);
  for (int k = 0; k < 3; ++k) {
    const __m512i from = _mm512_add_epi32(lanes, _mm512_set1_epi32(k));
    const __m512i in_ab = _mm512_permutex2var_epi32(a, from, b);  // Valid where from < 32.
    axes[std::size_t(k)] = _mm512_mask_permutexvar_epi32(
        in_ab, _mm512_cmpgt_epi32_mask(from, _mm512_set1_epi32(31)), from, c);
  }
}

LEFORT_STEP void append(Points& points, __mmask16 which, const __m512i& number_yx, const __m512i& z,
                        const std::array<__m512i, 3>& t) {
  const std::size_t to = points.count;
  _mm512_storeu_si512(&points.number_yx[to], _mm512_maskz_compress_epi32(which, number_yx));
  _mm512_storeu_si512(&points.z[to], _mm512_maskz_compress_epi32(which, z));
  for (std::size_t k = 0; k < 3; ++k)
    _mm512_storeu_si512(&points.t[k][to], _mm512_maskz_compress_epi32(which, t[k]));
  points.count += std::size_t(std::popcount(unsigned(which)));
}

/// Fills the last vector: lanes behind the last point use the first cell.
LEFORT_STEP void close(Points& points) {
  const std::size_t to = points.count;
  _mm512_storeu_si512(&points.number_yx[to], _mm512_setzero_si512());
  _mm512_storeu_si512(&points.z[to], _mm512_setzero_si512());
  for (auto& t : points.t) _mm512_storeu_ps(&t[to], _mm512_setzero_ps());
}

LEFORT_STEP std::array<__m512i, 3> cells_of(const Points& points, std::size_t first) {
  const __m512i packed = _mm512_load_si512(&points.number_yx[first]),
                maximum = _mm512_set1_epi32(kMaxCells - 1);
  return {_mm512_and_si512(packed, maximum),
          _mm512_and_si512(_mm512_srli_epi32(packed, kCellBits), maximum),
          _mm512_load_si512(&points.z[first])};
}

/// Points of a group by kind: whether both corners along x are in one leaf, all corners in one
/// brick.
template <class T>
struct ByKind {
  T paired_in_brick, paired, in_brick, others;
};

LEFORT_STEP __m512i join(const __m256i& low, const __m256i& high) {
  return _mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
}
LEFORT_STEP __m512i join(const __m256& low, const __m256& high) {
  return join(_mm256_castps_si256(low), _mm256_castps_si256(high));
}

/// Prefetches the next group while samples of this one are located.
inline void fetch_points(std::span<const Vec3> points) {
  const auto* const first = reinterpret_cast<const char*>(points.data());
  const std::size_t bytes = std::min(kGroup, points.size()) * sizeof(Vec3);
  for (std::size_t i = 0; i < bytes; i += kLineBytes) __builtin_prefetch(first + i);
}

/// Finds the cells of sixteen points and sorts them by kind. Points outside the cube, or not
/// finite, belong to no kind.
LEFORT_STEP void locate(const Lookup& lookup, const double* p, std::size_t first,
                        ByKind<Points>& points) {
  std::array<__m256i, 6> cells;
  std::array<__m256, 6> fractions;
  for (std::size_t i = 0; i < 6; ++i) {
    const __m512d u = _mm512_mul_pd(
        _mm512_sub_pd(_mm512_loadu_pd(p + 8 * i), _mm512_loadu_pd(&lookup.origin[8 * (i % 3)])),
        _mm512_set1_pd(lookup.cells_per_mm));
    cells[i] = _mm512_cvt_roundpd_epi32(u, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
    fractions[i] = _mm512_cvtpd_ps(_mm512_sub_pd(u, _mm512_cvtepi32_pd(cells[i])));
  }
  std::array<__m512i, 3> cell, t;
  by_axis(join(cells[0], cells[1]), join(cells[2], cells[3]), join(cells[4], cells[5]), cell);
  by_axis(join(fractions[0], fractions[1]), join(fractions[2], fractions[3]),
          join(fractions[4], fractions[5]), t);

  // Cells below the cube are negative, and those of NaN or too large numbers are the most negative
  // integer: as unsigned numbers all are large.
  const __m512i last_cell = _mm512_set1_epi32(lookup.last_cell);
  auto in_cube = __mmask16(kAll);
  for (std::size_t k = 0; k < 3; ++k) {
    const __mmask16 beyond = _mm512_cmpgt_epu32_mask(cell[k], last_cell);
    if (beyond != 0) [[unlikely]] {  // The upper face of the cube belongs to its last cell.
      const __mmask16 on_face = _mm512_mask_cmpeq_epi32_mask(
          _mm512_mask_cmpeq_epi32_mask(beyond, t[k], _mm512_setzero_si512()), cell[k],
          _mm512_add_epi32(last_cell, _mm512_set1_epi32(1)));
      cell[k] = _mm512_mask_mov_epi32(cell[k], on_face, last_cell);
      t[k] = _mm512_mask_mov_epi32(t[k], on_face, _mm512_castps_si512(_mm512_set1_ps(1.0F)));
      in_cube &= __mmask16(~(beyond & ~on_face));
    }
  }
  const __m512i three = _mm512_set1_epi32(3), seven = _mm512_set1_epi32(7);
  const __mmask16 in_row = _mm512_cmpneq_epi32_mask(_mm512_and_si512(cell[0], three), three);
  const __mmask16 in_brick = _mm512_cmpneq_epi32_mask(_mm512_and_si512(cell[0], seven), seven) &
                             _mm512_cmpneq_epi32_mask(_mm512_and_si512(cell[1], seven), seven) &
                             _mm512_cmpneq_epi32_mask(_mm512_and_si512(cell[2], seven), seven);
  const __m512i number =
      _mm512_add_epi32(_mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0),
                       _mm512_set1_epi32(int(first)));
  const __m512i number_yx = _mm512_or_si512(
      cell[0],
      _mm512_slli_epi32(_mm512_or_si512(cell[1], _mm512_slli_epi32(number, kCellBits)), kCellBits));
  append(points.paired_in_brick, __mmask16(in_cube & in_row & in_brick), number_yx, cell[2], t);
  append(points.paired, __mmask16(in_cube & in_row & ~in_brick), number_yx, cell[2], t);
  append(points.in_brick, __mmask16(in_cube & ~in_row & in_brick), number_yx, cell[2], t);
  append(points.others, __mmask16(in_cube & ~in_row & ~in_brick), number_yx, cell[2], t);
}

/// Table entries of sixteen bricks.
struct Entries {
  __m512i first_byte;  ///< Offset of the first leaf.
  __m512i stored;
};

LEFORT_STEP Entries entries_of(const Lookup& lookup, const __m512i& brick) {
  static_assert(sizeof(Brick) == 8);
  const __m512i low = _mm512_i32gather_epi64(_mm512_castsi512_si256(brick), lookup.bricks, 8),
                high =
                    _mm512_i32gather_epi64(_mm512_extracti64x4_epi64(brick, 1), lookup.bricks, 8);
  const __m512i even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0);
  const __m512i odd = _mm512_add_epi32(even, _mm512_set1_epi32(1));
  const __m512i leaf = _mm512_permutex2var_epi32(low, even, high);
  static_assert(BrickSamples::kLeafBytes == 128 + 64);
  return {_mm512_add_epi32(_mm512_slli_epi32(leaf, 7), _mm512_slli_epi32(leaf, 6)),
          _mm512_and_si512(_mm512_permutex2var_epi32(low, odd, high), _mm512_set1_epi32(0xFF))};
}

/// Number of bits set in the lowest byte of each lane; other bytes are zero.
LEFORT_STEP __m512i bits_in_byte(const __m512i& bytes) {
  const __m512i of_nibble =
      _mm512_broadcast_i32x4(_mm_set_epi8(4, 3, 3, 2, 3, 2, 2, 1, 3, 2, 2, 1, 2, 1, 1, 0));
  const __m512i low = _mm512_and_si512(bytes, _mm512_set1_epi32(15));
  return _mm512_add_epi32(_mm512_shuffle_epi8(of_nibble, low),
                          _mm512_shuffle_epi8(of_nibble, _mm512_srli_epi32(bytes, 4)));
}

/// Contribution of one coordinate to the address of a sample.
struct AxisOffset {
  __m512i brick, leaf, offset;
};

LEFORT_STEP AxisOffset axis_offset(const __m512i& coordinate, int brick_stride, unsigned axis) {
  const __m512i brick = _mm512_add_epi32(_mm512_srli_epi32(coordinate, 3), _mm512_set1_epi32(1));
  const __m512i leaf = _mm512_and_si512(_mm512_srli_epi32(coordinate, 2), _mm512_set1_epi32(1));
  const __m512i within_leaf = _mm512_and_si512(coordinate, _mm512_set1_epi32(3));
  return {_mm512_mullo_epi32(brick, _mm512_set1_epi32(brick_stride)), _mm512_slli_epi32(leaf, axis),
          _mm512_mullo_epi32(within_leaf,
                             _mm512_set1_epi32(int(BrickSamples::kCodeBytes) << (2 * axis)))};
}

/// Addresses of the samples of the points of one kind.
struct SampleOffsets {
  /// Byte offsets from the first code, by corner, or by row of two corners if these are paired; 0
  /// for a leaf that is not stored.
  alignas(64) std::array<std::array<std::int32_t, kGroup + kLanes>, kCorners> byte;
  /// One bit per point: all its leaves are stored.
  std::array<std::uint16_t, kGroup / kLanes + 1> stored;
};

/// Offset of eight bytes that contain a sample and the next one along x. They must not exceed the
/// row, which may be the last one: for the third pair they begin two bytes early.
LEFORT_STEP AxisOffset pair_offset(const __m512i& coordinate) {
  AxisOffset pair = axis_offset(coordinate, 1, 0);
  const __m512i x = _mm512_and_si512(coordinate, _mm512_set1_epi32(3));
  // 0, 3, 4.
  pair.offset = _mm512_mask_add_epi32(x, _mm512_test_epi32_mask(x, x), x, _mm512_set1_epi32(2));
  return pair;
}

/// Byte offsets of a corner of sixteen cells; clears bits of `stored` for leaves that are not
/// stored.
LEFORT_STEP __m512i byte_of(const Entries& entries, const __m512i& leaf, const __m512i& offset,
                            __mmask16& stored) {
  const __m512i one = _mm512_set1_epi32(1);
  const __m512i bit = _mm512_sllv_epi32(one, leaf);
  const __m512i before = _mm512_and_si512(entries.stored, _mm512_sub_epi32(bit, one));
  const __mmask16 here = _mm512_test_epi32_mask(entries.stored, bit);
  stored &= here;
  const __m512i leaf_bytes = _mm512_set1_epi32(int(BrickSamples::kLeafBytes));
  return _mm512_maskz_add_epi32(here, _mm512_add_epi32(entries.first_byte, offset),
                                _mm512_madd_epi16(bits_in_byte(before), leaf_bytes));
}

/// Computes the addresses of the samples of all points of a kind, and prefetches them if they may
/// be far away: those of a z slice of a leaf are in one or two cache lines.
template <bool are_paired, bool are_in_brick>
LEFORT_STEP void find_samples(const Lookup& lookup, const Points& points, SampleOffsets& offsets) {
  const std::array<int, 3> strides = {1, lookup.side, lookup.side * lookup.side};
  const __m512i one = _mm512_set1_epi32(1);
  constexpr std::size_t kAlongX = are_paired ? 1 : 2, kFound = kCorners / 2 * kAlongX;
  for (std::size_t first = 0; first < points.count; first += kLanes) {
    const std::array<__m512i, 3> cell = cells_of(points, first);
    std::array<std::array<AxisOffset, 2>, 3> at;
    for (std::size_t k = 0; k < 3; ++k) {
      const __m512i& c = cell[k];
      at[k][0] = are_paired && k == 0 ? pair_offset(c) : axis_offset(c, strides[k], unsigned(k));
      at[k][1] = axis_offset(_mm512_add_epi32(c, one), strides[k], unsigned(k));
    }
    auto stored = __mmask16(kAll);
    Entries entries;
#pragma GCC unroll 8
    for (std::size_t i = 0; i < kFound; ++i) {
      const std::size_t row = i / kAlongX;
      const AxisOffset &x = at[0][i % kAlongX], &y = at[1][row & 1], &z = at[2][row >> 1];
      if (i == 0 || !are_in_brick)
        entries = entries_of(lookup, _mm512_add_epi32(x.brick, _mm512_add_epi32(y.brick, z.brick)));
      const __m512i leaf = _mm512_or_si512(x.leaf, _mm512_or_si512(y.leaf, z.leaf)),
                    offset = _mm512_add_epi32(x.offset, _mm512_add_epi32(y.offset, z.offset));
      _mm512_store_si512(&offsets.byte[i][first], byte_of(entries, leaf, offset, stored));
    }
    offsets.stored[first / kLanes] = stored;
    if (!lookup.fetch) continue;
    for (const std::size_t i : {std::size_t(0), kAlongX + kAlongX - 1, 2 * kAlongX, kFound - 1})
      for (std::size_t l = first; l < first + kLanes; ++l)
        __builtin_prefetch(lookup.codes + offsets.byte[i][l]);
  }
}

/// Reads words for whole vectors with plain loads: faster than a gather on processors that split it
/// into many steps (AMD). Not inlined, because the compiler would turn it into gathers.
///
/// \param count  number of points; is rounded up to whole vectors.
template <class Word>
[[gnu::noinline]] void read_words(const std::byte* first, const std::int32_t* bytes,
                                  std::size_t count, Word* words) {
  for (std::size_t i = 0; i < count; i += kLanes)
#pragma GCC unroll 16
    for (std::size_t l = 0; l < kLanes; ++l)
      std::memcpy(words + i + l, first + bytes[i + l], sizeof(Word));
}

/// The code in the lower three bytes of each lane.
LEFORT_STEP __m512i code_in(const __m512i& words) {
  return _mm512_srai_epi32(_mm512_slli_epi32(words, 8), 8);
}

/// Codes of sixteen pairs.
///
/// \param shift  in bits, for each half: 16 where the bytes begin early.
LEFORT_STEP void codes_of_pairs(const std::uint64_t* words, const std::array<__m512i, 2>& shift,
                                __m512i& low, __m512i& high) {
  const __m512i even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0);
  std::array<__m512i, 2> pairs;
  for (std::size_t half = 0; half < 2; ++half)
    pairs[half] = _mm512_srlv_epi64(_mm512_load_si512(words + half * kLanes / 2), shift[half]);
  low = code_in(_mm512_permutex2var_epi32(pairs[0], even, pairs[1]));
  high = code_in(_mm512_permutex2var_epi32(_mm512_srli_epi64(pairs[0], 24), even,
                                           _mm512_srli_epi64(pairs[1], 24)));
}

/// Interpolates at all points of a kind and stores the distances by point number. Points without a
/// distance are not changed.
template <bool are_paired>
LEFORT_STEP void interpolate(const Lookup& lookup, const Points& points,
                             const SampleOffsets& offsets, float quantum_mm,
                             std::array<float, kGroup>& distances) {
  using Word = std::conditional_t<are_paired, std::uint64_t, std::uint32_t>;
  constexpr std::size_t kWords = are_paired ? kCorners / 2 : kCorners;
  alignas(64) std::array<std::array<Word, kChunk>, kWords> words;
  for (std::size_t first = 0; first < points.count; first += kLanes) {
    if (first % kChunk == 0)
      for (std::size_t i = 0; i < kWords; ++i)
        read_words(lookup.codes, &offsets.byte[i][first], std::min(kChunk, points.count - first),
                   words[i].data());
    std::array<__m512i, kCorners> codes;
    if constexpr (are_paired) {
      const __m512i x = _mm512_load_si512(&points.number_yx[first]),
                    early = _mm512_maskz_set1_epi32(_mm512_test_epi32_mask(x, _mm512_set1_epi32(2)),
                                                    16);
      const std::array<__m512i, 2> shift = {
          _mm512_cvtepu32_epi64(_mm512_castsi512_si256(early)),
          _mm512_cvtepu32_epi64(_mm512_extracti64x4_epi64(early, 1))};
#pragma GCC unroll 4
      for (std::size_t row = 0; row < kCorners / 2; ++row)
        codes_of_pairs(words[row].data() + first % kChunk, shift, codes[2 * row],
                       codes[2 * row + 1]);
    } else {
#pragma GCC unroll 8
      for (std::size_t corner = 0; corner < kCorners; ++corner)
        codes[corner] = code_in(_mm512_load_si512(words[corner].data() + first % kChunk));
    }
    std::array<Floats, kCorners> corners;
    __m512i largest = _mm512_setzero_si512();
    for (std::size_t corner = 0; corner < kCorners; ++corner) {
      corners[corner] = Floats(_mm512_cvtepi32_ps(codes[corner]));
      largest = _mm512_max_epi32(largest, _mm512_abs_epi32(codes[corner]));
    }
    std::array<Floats, 3> t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = Floats(_mm512_load_ps(&points.t[k][first]));
    const Floats distance = trilinear(corners, t) * quantum_mm;
    const auto known =
        __mmask16(offsets.stored[first / kLanes] &
                  _mm512_cmplt_epi32_mask(largest, _mm512_set1_epi32(BrickSamples::kBeyond)));
    alignas(64) std::array<float, kLanes> found;
    _mm512_store_ps(found.data(),
                    _mm512_mask_mov_ps(_mm512_set1_ps(kNone), known, __m512(distance)));
    const std::size_t count = std::min(kLanes, points.count - first);
    for (std::size_t l = 0; l < count; ++l)
      distances[std::uint32_t(points.number_yx[first + l]) >> (2 * kCellBits)] = found[l];
  }
}

/// A bit for each of sixteen points without a distance.
LEFORT_STEP unsigned missing(const std::array<float, kGroup>& distances, std::size_t first) {
  const __m512 d = _mm512_load_ps(&distances[first]);
  return _mm512_cmp_ps_mask(d, d, _CMP_UNORD_Q);
}

/// The value for the zone of a point without a distance.
float zone_value_at(const BrickSamples& samples, const FieldFrame& frame, const Lookup& lookup,
                    const Vec3& p_B) {
  LatticePoint cell{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double u = (p_B[Index(k)] - lookup.origin[k]) * lookup.cells_per_mm;
    if (!(u >= 0.0 && u <= lookup.maximum)) return zone_value(zone_beyond_box(frame, p_B));
    cell[k] = std::min(int(u), lookup.last_cell);
  }
  return zone_value(zone_of(samples.cell(cell).corners));
}

}  // namespace

bool fits_avx512(const BrickSamples& samples) {
  // Leaves that are not stored are replaced by the first one, so there must be one.
  return samples.resolution() <= kMaxCells && samples.codes().size() > BrickSamples::kLeafBytes &&
         samples.codes().size() <= std::size_t(std::numeric_limits<std::int32_t>::max());
}

__attribute__((target(LEFORT_TARGET))) void distances_avx512(const BrickSamples& samples,
                                                             const FieldFrame& frame,
                                                             std::span<const Vec3> p_B,
                                                             std::span<float> distances_mm) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  LEFORT_CHECK(fits_avx512(samples) && samples.resolution() == frame.resolution);
  Lookup lookup{samples.bricks().data(),
                samples.codes().data(),
                SparseLattice::bricks_per_side(samples.resolution()),
                frame.resolution - 1,
                samples.codes().size() > kCacheBytes,
                double(frame.resolution),
                1.0 / frame.cell_mm,
                {}};
  for (std::size_t i = 0; i < lookup.origin.size(); ++i)
    lookup.origin[i] = frame.origin_B[Index(i % 3)];
  ByKind<Points> points;
  ByKind<SampleOffsets> offsets;
  std::array<Vec3, kGroup + kLanes> last;
  alignas(64) std::array<float, kGroup> found;
  const float quantum_mm = samples.quantum_mm();
  for (std::size_t begin = 0; begin < p_B.size(); begin += kGroup) {
    const std::size_t count = std::min(kGroup, p_B.size() - begin);
    const double* p = p_B.data()[begin].data();
    if (count < kGroup) {
      std::copy_n(p_B.begin() + std::ptrdiff_t(begin), count, last.begin());
      std::fill_n(last.begin() + std::ptrdiff_t(count), kLanes - 1, p_B[begin]);
      p = last.data()->data();
    }
    points.paired_in_brick.count = points.paired.count = points.in_brick.count =
        points.others.count = 0;
    for (std::size_t n = 0; n < count; n += kLanes) locate(lookup, p + 3 * n, n, points);
    fetch_points(p_B.subspan(begin + count));
    for (Points* kind : {&points.paired_in_brick, &points.paired, &points.in_brick, &points.others})
      close(*kind);
    find_samples<true, true>(lookup, points.paired_in_brick, offsets.paired_in_brick);
    find_samples<true, false>(lookup, points.paired, offsets.paired);
    find_samples<false, true>(lookup, points.in_brick, offsets.in_brick);
    find_samples<false, false>(lookup, points.others, offsets.others);
    found.fill(kNone);
    interpolate<true>(lookup, points.paired_in_brick, offsets.paired_in_brick, quantum_mm, found);
    interpolate<true>(lookup, points.paired, offsets.paired, quantum_mm, found);
    interpolate<false>(lookup, points.in_brick, offsets.in_brick, quantum_mm, found);
    interpolate<false>(lookup, points.others, offsets.others, quantum_mm, found);
    std::copy_n(found.begin(), count, distances_mm.begin() + std::ptrdiff_t(begin));
    for (std::size_t n = 0; n < count; n += kLanes)
      for (unsigned none = missing(found, n); none != 0; none &= none - 1) {
        const std::size_t i = n + std::size_t(std::countr_zero(none));
        if (i < count)
          distances_mm[begin + i] = zone_value_at(samples, frame, lookup, p_B[begin + i]);
      }
  }
}

}  // namespace lefort::field::internal

#endif
