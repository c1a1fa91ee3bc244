/// \file
/// Distances of sixteen points at once from a triangle: the kernel of loops over triangles.
///
/// All functions are inlined into functions that are compiled for one instruction set each; all
/// give the same bits.
#pragma once

#include <lefort/field/build/nearest_in_brick.h>
#include <lefort/field/build/triangle_frame.h>
#include <lefort/field/internal/pack.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lefort::field::internal {

inline constexpr std::size_t kLanes = NearestInBrick::kTilePoints;
inline constexpr int kSide = SparseLattice::kSide;
static_assert(kLanes == 16);

/// Values at the points of a tile.
template <Simd simd>
using Floats = Pack<float, kLanes, simd>;
template <Simd simd>
using Ints = Pack<std::int32_t, kLanes, simd>;

/// The seven quantities of TriangleFrame, and one for padding.
inline constexpr std::size_t kHeight = 0, kAlong = 1, kOutward = 4, kQuantities = 8;
using Quantities = std::array<float, kQuantities>;

/// A triangle in the coordinates of a brick.
struct alignas(32) Planes {
  Quantities at_low{};               ///< The quantities at the first point of the brick.
  std::array<Quantities, 3> step{};  ///< Their change from point to point along each axis.
  std::array<float, 3> length;
  float inside_limit;  ///< Max r_i inside the triangle: 0; -infinity for one without area.
  std::array<int, 3> low, high;  ///< Points near its box: from `low` to before `high`.
};

/// Triangles that are prepared together.
inline constexpr std::size_t kBatch = 8;
template <Simd simd>
using Doubles = Pack<double, kBatch, simd>;
using Lanes = std::array<double, kBatch>;

template <Simd simd>
struct Vectors {
  Doubles<simd> x, y, z;

  friend LEFORT_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend LEFORT_INLINE Vectors operator-(const Vectors& a) { return {-a.x, -a.y, -a.z}; }
  friend LEFORT_INLINE Vectors operator*(const Vectors& a, const Doubles<simd>& s) {
    return {a.x * s, a.y * s, a.z * s};
  }
  friend LEFORT_INLINE Doubles<simd> dot(const Vectors& a, const Vectors& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  friend LEFORT_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};

template <Simd simd>
LEFORT_INLINE Doubles<simd> square_root(const Doubles<simd>& values) {
#if defined(__x86_64__)
  if constexpr (simd == Simd::kAvx2)
    return Doubles<simd>::of([&](std::size_t n) __attribute__((always_inline)) {
      return __builtin_ia32_sqrtpd256(values.parts[n]);
    });
#endif
  Doubles<simd> roots;
  for (std::size_t n = 0; n < roots.kParts; ++n)
    for (std::size_t l = 0; l < roots.kPartLanes; ++l)
      roots.parts[n][l] = __builtin_sqrt(values.parts[n][l]);
  return roots;
}

template <Simd simd>
LEFORT_INLINE Lanes lanes_of(const Doubles<simd>& values) {
  Lanes lanes;
  values.store(lanes.data());
  return lanes;
}

using Batch = std::array<Planes, kBatch>;

template <Simd simd>
LEFORT_INLINE void set_quantity(Batch& batch, std::size_t which, const Vectors<simd>& direction,
                                const Vectors<simd>& origin, double cell) {
  const Lanes at_low = lanes_of(-dot(direction, origin));
  const Vectors<simd> step = direction * Doubles<simd>::filled(cell);
  const std::array<Lanes, 3> steps = {lanes_of(step.x), lanes_of(step.y), lanes_of(step.z)};
  for (std::size_t l = 0; l < kBatch; ++l) {
    batch[l].at_low[which] = float(at_low[l]);
    for (std::size_t k = 0; k < 3; ++k) batch[l].step[k][which] = float(steps[k][l]);
  }
}

/// Range of points from `from` to `to`, both in cells, limited to 0 to kSide: the first point and
/// one after the last.
template <Simd simd>
LEFORT_INLINE void set_range(const Doubles<simd>& from, const Doubles<simd>& to, std::size_t axis,
                             Batch& batch) {
  const auto zero = Doubles<simd>::filled(0.0), maximum = Doubles<simd>::filled(double(kSide));
  const Lanes below = lanes_of(maximum - larger(zero, smaller(maximum, from)));
  const Lanes above = lanes_of(larger(zero, smaller(maximum, to + 1.0)));
  for (std::size_t l = 0; l < kBatch; ++l) {
    batch[l].low[axis] = kSide - int(below[l]);
    batch[l].high[axis] = int(above[l]);
  }
}

/// triangle_frame() for several triangles at once, in the coordinates of a brick.
///
/// \returns a bit for each triangle without area.
template <Simd simd>
LEFORT_INLINE unsigned prepare(const std::array<Vectors<simd>, 3>& corners, double cell,
                               double max_distance_mm, Batch& batch) {
  std::array<Vectors<simd>, 3> along;
  std::array<Doubles<simd>, 3> squared;
  for (std::size_t i = 0; i < 3; ++i) {
    along[i] = corners[(i + 1) % 3] - corners[i];
    squared[i] = dot(along[i], along[i]);
  }
  const Vectors<simd> n = cross(along[0], corners[2] - corners[0]);
  const Doubles<simd> n2 = dot(n, n);
  const Doubles<simd> longest = larger(squared[0], larger(squared[1], squared[2]));
  constexpr double kRatio = geometry::kDegenerateHeightRatio;
  const Lanes area = lanes_of(n2), limit = lanes_of(longest * (kRatio * kRatio) * longest);
  unsigned flat = 0;
  for (std::size_t l = 0; l < kBatch; ++l)
    if (!(area[l] > limit[l])) flat |= 1U << l;

  const Vectors<simd> normal = n * (1.0 / square_root(n2));
  set_quantity(batch, kHeight, normal, corners[0], cell);
  for (std::size_t i = 0; i < 3; ++i) {
    const Doubles<simd> length = square_root(squared[i]);
    const Vectors<simd> unit = along[i] * (1.0 / length);
    set_quantity(batch, kAlong + i, unit, corners[i], cell);
    set_quantity(batch, kOutward + i, cross(unit, normal), corners[i], cell);
    const Lanes lengths = lanes_of(length);
    for (std::size_t l = 0; l < kBatch; ++l) batch[l].length[i] = float(lengths[l]);
  }
  const double per_cell = 1.0 / cell;
  const auto along_axis = [&](const Doubles<simd>& a, const Doubles<simd>& b,
                              const Doubles<simd>& c, std::size_t axis)
      __attribute__((always_inline)) {
    set_range((smaller(a, smaller(b, c)) - max_distance_mm) * per_cell,
              (larger(a, larger(b, c)) + max_distance_mm) * per_cell, axis, batch);
  };
  along_axis(corners[0].x, corners[1].x, corners[2].x, 0);
  along_axis(corners[0].y, corners[1].y, corners[2].y, 1);
  along_axis(corners[0].z, corners[1].z, corners[2].z, 2);
  for (Planes& planes : batch) planes.inside_limit = 0.0F;
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
template <Simd simd>
LEFORT_INLINE Floats<simd> squared_to_side(const Floats<simd>& along, const Floats<simd>& outward,
                                           float length) {
  const Floats<simd> beyond = larger(larger(-along, along - length), Floats<simd>::filled(0.0F));
  return outward * outward + beyond * beyond;
}

/// Positions of the points of a tile, in cells from its first point.
inline constexpr std::array<float, kLanes> kTileX_cells = {0, 1, 2, 3, 0, 1, 2, 3,
                                                           0, 1, 2, 3, 0, 1, 2, 3};
inline constexpr std::array<float, kLanes> kTileY_cells = {0, 0, 0, 0, 1, 1, 1, 1,
                                                           0, 0, 0, 0, 1, 1, 1, 1};
inline constexpr std::array<float, kLanes> kTileZ_cells = {0, 0, 0, 0, 0, 0, 0, 0,
                                                           1, 1, 1, 1, 1, 1, 1, 1};
static_assert(NearestInBrick::kTileX == 4 && NearestInBrick::kTileY == 2 &&
              NearestInBrick::kTileZ == 2);

/// Change of a quantity within a tile.
template <Simd simd>
LEFORT_INLINE Floats<simd> within_tile(const Planes& planes, std::size_t quantity) {
  using F = Floats<simd>;
  return F::loaded(kTileX_cells.data()) * planes.step[0][quantity] +
         F::loaded(kTileY_cells.data()) * planes.step[1][quantity] +
         F::loaded(kTileZ_cells.data()) * planes.step[2][quantity];
}

/// Updates the points of a tile that are closer to this triangle than to the nearest one so far.
///
/// \param quantity  maps the number of a quantity to its values at the points of the tile.
/// \param offset    position of the first point of the tile.
template <Simd simd, class Quantity>
LEFORT_INLINE void visit_tile(const Planes& planes, const Quantity& quantity, std::int32_t triangle,
                              std::size_t offset, NearestInBrick& nearest) {
  using F = Floats<simd>;
  using I = Ints<simd>;
  const F none = F::filled(0.0F);
  const F height = quantity(kHeight);
  const F out_0 = quantity(kOutward), out_1 = quantity(kOutward + 1),
          out_2 = quantity(kOutward + 2);
  const F out = larger(out_0, larger(out_1, out_2));
  const F beyond = larger(out, none);
  const F height2 = height * height;
  const F known = F::loaded(&nearest.squared_mm2[offset]);
  // Lower bound of the distance, exact unless the closest point is a corner: rules out three of
  // four triangles.
  if (!any_less(height2 + beyond * beyond, known)) return;

  const F to_boundary =
      smaller(squared_to_side(quantity(kAlong), out_0, planes.length[0]),
              smaller(squared_to_side(quantity(kAlong + 1), out_1, planes.length[1]),
                      squared_to_side(quantity(kAlong + 2), out_2, planes.length[2])));
  const I inside = out <= F::filled(planes.inside_limit);
  const F squared = height2 + select(inside, none, to_boundary);

  const I nearer = squared < known;
  select(nearer, squared, known).store(&nearest.squared_mm2[offset]);
  static_assert(NearestInBrick::kTriangleShift == 2 && NearestInBrick::kFaceBit == 1 &&
                NearestInBrick::kBelowBit == 0);
  // True lanes are -1, so subtracting them sets a bit.
  const I code = I::filled(4 * triangle) - inside - inside - (height < none);
  select(nearer, code, I::loaded(&nearest.code[offset])).store(&nearest.code[offset]);
}

/// Prepares at most kBatch triangles for visit_tile().
///
/// \param low  position of the first point of the brick.
template <Simd simd>
LEFORT_INLINE void prepare_triangles(const geometry::TriangleMesh& mesh,
                                     std::span<const std::int32_t> triangles, const Vec3& low,
                                     double cell, double max_distance_mm, Batch& batch) {
  std::array<std::array<Lanes, 3>, 3> lanes;  // By corner and axis.
  for (std::size_t l = 0; l < kBatch; ++l) {
    const geometry::Triangle& t =
        mesh.triangles[std::size_t(triangles[std::min(l, triangles.size() - 1)])];
    for (std::size_t i = 0; i < 3; ++i) {
      const double* const p = mesh.vertices[std::size_t(t[i])].data();
      for (std::size_t k = 0; k < 3; ++k) lanes[i][k][l] = p[k] - low.data()[k];
    }
  }
  std::array<Vectors<simd>, 3> corners;
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] = {Doubles<simd>::loaded(lanes[i][0].data()),
                  Doubles<simd>::loaded(lanes[i][1].data()),
                  Doubles<simd>::loaded(lanes[i][2].data())};
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
