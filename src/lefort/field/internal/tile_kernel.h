/// \file
/// Distances of sixteen points at once from a triangle: the kernel of loops over triangles.
///
/// All functions are inlined into functions that are compiled for one instruction set each; all
/// give the same bits.
#pragma once

#include <lefort/field/build/nearest_in_brick.h>
#include <lefort/field/build/triangle_frame.h>
#include <lefort/field/internal/simd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace lefort::field::internal {

// Generic vectors: the compiler maps them to the registers of each target. Sixteen lanes are a
// tile.
inline constexpr std::size_t kLanes = NearestInBrick::kTilePoints;
inline constexpr int kSide = SparseLattice::kSide;
static_assert(kLanes == 16);
using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));
using Ints = std::int32_t __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

/// The seven quantities of TriangleFrame, and one for padding.
inline constexpr std::size_t kHeight = 0, kAlong = 1, kOutward = 4, kSpare = 7, kQuantities = 8;
using Quantities = float __attribute__((vector_size(kQuantities * sizeof(float))));

/// A triangle in the coordinates of a brick.
struct Planes {
  Quantities at_low;               ///< The quantities at the first point of the brick.
  std::array<Quantities, 3> step;  ///< Their change from point to point along each axis.
  std::array<float, 3> length;
  float inside_limit;  ///< Max r_i inside the triangle: 0; -infinity for one without area.
  std::array<int, 3> low, high;  ///< Points near its box: from `low` to before `high`.
};

/// Triangles that are prepared together.
inline constexpr std::size_t kBatch = 8;
using Doubles = double __attribute__((vector_size(kBatch * sizeof(double))));
using Lanes = std::array<double, kBatch>;

struct Vectors {
  Doubles x, y, z;
};

LEFORT_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
LEFORT_INLINE Vectors operator-(const Vectors& a) { return {-a.x, -a.y, -a.z}; }
LEFORT_INLINE Vectors operator*(const Vectors& a, const Doubles& s) {
  return {a.x * s, a.y * s, a.z * s};
}
LEFORT_INLINE Doubles dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
LEFORT_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
LEFORT_INLINE Doubles square_root(const Doubles& values) {
  Doubles roots{};
  for (std::size_t l = 0; l < kBatch; ++l) roots[l] = __builtin_sqrt(values[l]);
  return roots;
}
template <class V>
LEFORT_INLINE V smaller(const V& a, const V& b) {
  return a < b ? a : b;
}
template <class V>
LEFORT_INLINE V larger(const V& a, const V& b) {
  return a > b ? a : b;
}

using Batch = std::array<Planes, kBatch>;

LEFORT_INLINE void set_quantity(Batch& batch, std::size_t which, const Vectors& direction,
                                const Vectors& origin, double cell) {
  const Doubles at_low = -dot(direction, origin);
  const Vectors step = direction * (Doubles{} + cell);
  for (std::size_t l = 0; l < kBatch; ++l) {
    batch[l].at_low[which] = float(at_low[l]);
    batch[l].step[0][which] = float(step.x[l]);
    batch[l].step[1][which] = float(step.y[l]);
    batch[l].step[2][which] = float(step.z[l]);
  }
}

/// Range of points from `from` to `to`, both in cells, limited to 0 to kSide: the first point and
/// one after the last.
LEFORT_INLINE void set_range(const Doubles& from, const Doubles& to, std::size_t axis,
                             Batch& batch) {
  const Doubles zero{};
  const Doubles maximum = zero + double(kSide);
  const Doubles below = maximum - larger(zero, smaller(maximum, from));
  const Doubles above = larger(zero, smaller(maximum, to + 1.0));
  for (std::size_t l = 0; l < kBatch; ++l) {
    batch[l].low[axis] = kSide - int(below[l]);
    batch[l].high[axis] = int(above[l]);
  }
}

/// triangle_frame() for several triangles at once, in the coordinates of a brick.
///
/// \returns a bit for each triangle without area.
LEFORT_INLINE unsigned prepare(const std::array<Vectors, 3>& corners, double cell,
                               double max_distance_mm, Batch& batch) {
  std::array<Vectors, 3> along;
  std::array<Doubles, 3> squared;
  for (std::size_t i = 0; i < 3; ++i) {
    along[i] = corners[(i + 1) % 3] - corners[i];
    squared[i] = dot(along[i], along[i]);
  }
  const Vectors n = cross(along[0], corners[2] - corners[0]);
  const Doubles n2 = dot(n, n);
  const Doubles longest = larger(squared[0], larger(squared[1], squared[2]));
  constexpr double kRatio = geometry::kDegenerateHeightRatio;
  unsigned flat = 0;
  for (std::size_t l = 0; l < kBatch; ++l)
    if (!(n2[l] > kRatio * kRatio * longest[l] * longest[l])) flat |= 1U << l;

  const Vectors normal = n * (1.0 / square_root(n2));
  set_quantity(batch, kHeight, normal, corners[0], cell);
  for (std::size_t i = 0; i < 3; ++i) {
    const Doubles length = square_root(squared[i]);
    const Vectors unit = along[i] * (1.0 / length);
    set_quantity(batch, kAlong + i, unit, corners[i], cell);
    set_quantity(batch, kOutward + i, cross(unit, normal), corners[i], cell);
    for (std::size_t l = 0; l < kBatch; ++l) batch[l].length[i] = float(length[l]);
  }
  const double per_cell = 1.0 / cell;
  const auto along_axis = [&](const Doubles& a, const Doubles& b, const Doubles& c,
                              std::size_t axis) __attribute__((always_inline)) {
    set_range((smaller(a, smaller(b, c)) - max_distance_mm) * per_cell,
              (larger(a, larger(b, c)) + max_distance_mm) * per_cell, axis, batch);
  };
  along_axis(corners[0].x, corners[1].x, corners[2].x, 0);
  along_axis(corners[0].y, corners[1].y, corners[2].y, 1);
  along_axis(corners[0].z, corners[1].z, corners[2].z, 2);
  for (Planes& planes : batch) {
    planes.inside_limit = 0.0F;
    planes.at_low[kSpare] = 0.0F;
    for (Quantities& step : planes.step) step[kSpare] = 0.0F;
  }
  return flat;
}

/// As prepare(), for a triangle without area; its box does not change.
LEFORT_INLINE void prepare_flat(const TriangleFrame& frame, double cell, Planes& planes) {
  const auto set = [&](std::size_t which, const Vec3& direction, const Vec3& origin) {
    planes.at_low[which] = float(-direction.dot(origin));
    for (int k = 0; k < 3; ++k) planes.step[std::size_t(k)][which] = float(cell * direction[k]);
  };
  set(kHeight, frame.normal, frame.corners[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    set(kAlong + i, frame.along[i], frame.corners[i]);
    set(kOutward + i, frame.outward[i], frame.corners[i]);
    planes.length[i] = float(frame.length[i]);
  }
  planes.inside_limit = -INFINITY;
}

/// Squared in-plane distance to an edge.
LEFORT_INLINE Floats squared_to_side(const Floats& along, const Floats& outward, float length) {
  const Floats beyond = larger(larger(-along, along - length), Floats{});
  return outward * outward + beyond * beyond;
}

/// True if a lane is true; true lanes are -1.
LEFORT_INLINE bool any(const Ints& lanes) {
  using Eight = std::int32_t __attribute__((vector_size(8 * sizeof(std::int32_t))));
  const Eight eight = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3, 4, 5, 6, 7) |
                      __builtin_shufflevector(lanes, lanes, 8, 9, 10, 11, 12, 13, 14, 15);
  const auto four = __builtin_shufflevector(eight, eight, 0, 1, 2, 3) |
                    __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
#if defined(__SSE2__)
  return _mm_movemask_epi8(reinterpret_cast<__m128i>(four)) != 0;
#else
  return (four[0] | four[1] | four[2] | four[3]) != 0;
#endif
}

/// True if a lane of `a` is less than that of `b`: both Floats or both Doubles. Compilers do not
/// use the mask registers of AVX-512 for this.
template <Simd simd, class V>
LEFORT_INLINE bool any_less(const V& a, const V& b) {
  static_assert(sizeof(V) == sizeof(Ints));
#if defined(__x86_64__)
  constexpr int kLess = 1, kCurrentRounding = 4;
  if constexpr (simd == Simd::kAvx512 && sizeof(a[0]) == sizeof(float))
    return __builtin_ia32_cmpps512_mask(a, b, kLess, -1, kCurrentRounding) != 0;
  if constexpr (simd == Simd::kAvx512 && sizeof(a[0]) == sizeof(double))
    return __builtin_ia32_cmppd512_mask(a, b, kLess, -1, kCurrentRounding) != 0;
#endif
  return any(Ints(a < b));
}

/// Positions of the points of a tile, in cells from its first point.
inline constexpr Floats kTileX_cells = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
inline constexpr Floats kTileY_cells = {0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1};
inline constexpr Floats kTileZ_cells = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
static_assert(NearestInBrick::kTileX == 4 && NearestInBrick::kTileY == 2 &&
              NearestInBrick::kTileZ == 2);

/// Change of a quantity within a tile.
LEFORT_INLINE Floats within_tile(const Planes& planes, std::size_t quantity) {
  return kTileX_cells * planes.step[0][quantity] + kTileY_cells * planes.step[1][quantity] +
         kTileZ_cells * planes.step[2][quantity];
}

/// Updates the points of a tile that are closer to this triangle than to the nearest one so far.
///
/// \param quantity  maps the number of a quantity to its values at the points of the tile.
/// \param offset    position of the first point of the tile.
template <Simd simd, class Quantity>
LEFORT_INLINE void visit_tile(const Planes& planes, const Quantity& quantity, std::int32_t triangle,
                              std::size_t offset, NearestInBrick& nearest) {
  const Floats height = quantity(kHeight);
  const Floats out_0 = quantity(kOutward), out_1 = quantity(kOutward + 1),
               out_2 = quantity(kOutward + 2);
  const Floats out = larger(out_0, larger(out_1, out_2));
  const Floats beyond = larger(out, Floats{});
  const Floats height2 = height * height;
  auto& known = *reinterpret_cast<Floats*>(&nearest.squared_mm2[offset]);
  // Lower bound of the distance, exact unless the closest point is a corner: rules out three of
  // four triangles.
  if (!any_less<simd>(height2 + beyond * beyond, known)) return;

  const Floats to_boundary =
      smaller(squared_to_side(quantity(kAlong), out_0, planes.length[0]),
              smaller(squared_to_side(quantity(kAlong + 1), out_1, planes.length[1]),
                      squared_to_side(quantity(kAlong + 2), out_2, planes.length[2])));
  const Ints inside = out <= planes.inside_limit;
  const Floats squared = height2 + (inside ? Floats{} : to_boundary);

  auto& known_code = *reinterpret_cast<Ints*>(&nearest.code[offset]);
  const Ints nearer = squared < known;
  known = nearer ? squared : known;
  static_assert(NearestInBrick::kTriangleShift == 2 && NearestInBrick::kFaceBit == 1 &&
                NearestInBrick::kBelowBit == 0);
  // True lanes are -1, so subtracting them sets a bit.
  known_code = nearer ? 4 * triangle - 2 * inside - (height < Floats{}) : known_code;
}

/// Prepares at most kBatch triangles for visit_tile().
///
/// \param low  position of the first point of the brick.
LEFORT_INLINE void prepare_triangles(const geometry::TriangleMesh& mesh,
                                     std::span<const std::int32_t> triangles, const Vec3& low,
                                     double cell, double max_distance_mm, Batch& batch) {
  std::array<Vectors, 3> corners;
  for (std::size_t l = 0; l < kBatch; ++l) {
    const geometry::Triangle& t =
        mesh.triangles[std::size_t(triangles[std::min(l, triangles.size() - 1)])];
    for (std::size_t i = 0; i < 3; ++i) {
      const double* const p = mesh.vertices[std::size_t(t[i])].data();
      corners[i].x[l] = p[0] - low.data()[0];
      corners[i].y[l] = p[1] - low.data()[1];
      corners[i].z[l] = p[2] - low.data()[2];
    }
  }
  const unsigned flat = prepare(corners, cell, max_distance_mm, batch);
  for (std::size_t l = 0; flat != 0 && l < triangles.size(); ++l) {
    const std::int32_t t = triangles[l];
    if ((flat >> l & 1U) != 0)
      prepare_flat(
          triangle_frame(mesh.corner(t, 0) - low, mesh.corner(t, 1) - low, mesh.corner(t, 2) - low),
          cell, batch[l]);
  }
}

}  // namespace lefort::field::internal
