#include <lefort/field/build/triangle_brick_overlaps.h>
#include <lefort/field/internal/tile_kernel.h>

#include <array>

namespace lefort::field {

namespace {

using internal::Doubles;
using internal::kBatch;
using internal::kSide;
using internal::Lanes;
using internal::lanes_of;
using internal::Pack;
using internal::Vectors;

/// Half-spaces per triangle: two for its plane, three for its edges; rounded up to a register.
constexpr std::size_t kFaces = kBatch;
constexpr std::size_t kUsedFaces = 5;
/// From the center of the points of a brick to the last one, in bricks.
constexpr double kHalf = 0.5 * (kSide - 1) / kSide;

/// Triangles in brick coordinates: a brick is beyond a face of a triangle if first + x step[0] + y
/// step[1] + z step[2] > 0.
struct Fractions {
  std::array<std::array<double, kFaces>, kBatch> first;
  std::array<std::array<std::array<double, kFaces>, 3>, kBatch> step;
  std::array<std::array<int, kBatch>, 3> low, high;  ///< Bricks of the box, `high` included.
};

template <Simd simd>
LEFORT_INLINE Doubles<simd> magnitude(const Doubles<simd>& v) {
  return larger(v, -v);
}

template <Simd simd>
LEFORT_INLINE void set_face(Fractions& fractions, std::size_t face, const Vectors<simd>& outward,
                            const Doubles<simd>& length, const Vectors<simd>& at, double distance,
                            const typename Doubles<simd>::Mask& has_area) {
  const Doubles<simd> half =
      (magnitude(outward.x) + magnitude(outward.y) + magnitude(outward.z)) * kHalf;
  // The center of a brick is half a brick minus half a cell from its corner: kHalf.
  const Vectors<simd> to_middle = {at.x - kHalf, at.y - kHalf, at.z - kHalf};
  const Doubles<simd> first = -(dot(outward, to_middle) + length * distance + half);
  const auto none = Doubles<simd>::filled(0.0);
  const Lanes first_or_none = lanes_of(select(has_area, first, none - 1.0));
  const std::array<Lanes, 3> steps = {lanes_of(select(has_area, outward.x, none)),
                                      lanes_of(select(has_area, outward.y, none)),
                                      lanes_of(select(has_area, outward.z, none))};
  for (std::size_t l = 0; l < kBatch; ++l) {
    fractions.first[l][face] = first_or_none[l];
    for (std::size_t k = 0; k < 3; ++k) fractions.step[l][k][face] = steps[k][l];
  }
}

template <Simd simd>
LEFORT_INLINE void set_box(Fractions& fractions, std::size_t axis, const Doubles<simd>& a,
                           const Doubles<simd>& b, const Doubles<simd>& c, double distance,
                           int bricks_per_side) {
  const auto none = Doubles<simd>::filled(0.0),
             last = Doubles<simd>::filled(double(bricks_per_side - 1));
  const Doubles<simd> low = smaller(a, smaller(b, c)) - distance,
                      high = larger(a, larger(b, c)) + distance;
  const Lanes from = lanes_of(larger(none, smaller(last, low))),
              to = lanes_of(larger(none, smaller(last, high)));
  for (std::size_t l = 0; l < kBatch; ++l) {
    fractions.low[axis][l] = int(from[l]);
    fractions.high[axis][l] = int(to[l]);
  }
}

/// \param corners  in bricks, relative to the corner of brick (0, 0, 0).
template <Simd simd>
LEFORT_INLINE void prepare_fractions(const std::array<Vectors<simd>, 3>& corners, double distance,
                                     int bricks_per_side, Fractions& fractions) {
  const Vectors<simd> ab = corners[1] - corners[0], bc = corners[2] - corners[1],
                      ca = corners[0] - corners[2];
  const Vectors<simd> normal = cross(ab, corners[2] - corners[0]);
  const Doubles<simd> n2 = dot(normal, normal);
  const Doubles<simd> longest = larger(dot(ab, ab), larger(dot(bc, bc), dot(ca, ca)));
  constexpr double kRatio = geometry::kDegenerateHeightRatio;
  // If the normal is rounding, only the box is used. The factor is a margin for other rounding
  // errors.
  const typename Doubles<simd>::Mask has_area = longest * longest * (4.0 * kRatio * kRatio) < n2;
  const Doubles<simd> length = square_root(n2);
  set_face(fractions, 0, normal, length, corners[0], distance, has_area);
  set_face(fractions, 1, -normal, length, corners[0], distance, has_area);
  const std::array<const Vectors<simd>*, 3> along = {&ab, &bc, &ca};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vectors<simd> outward = cross(*along[i], normal);
    set_face(fractions, 2 + i, outward, square_root(dot(outward, outward)), corners[i], distance,
             has_area);
  }
  set_box(fractions, 0, corners[0].x, corners[1].x, corners[2].x, distance, bricks_per_side);
  set_box(fractions, 1, corners[0].y, corners[1].y, corners[2].y, distance, bricks_per_side);
  set_box(fractions, 2, corners[0].z, corners[1].z, corners[2].z, distance, bricks_per_side);
}

template <Simd simd>
LEFORT_INLINE void list_bricks(const Fractions& fractions, std::size_t l, int bricks_per_side,
                               std::vector<std::int32_t>& bricks) {
  using Faces = Pack<double, kFaces, simd>;
  const Faces step_x = Faces::loaded(fractions.step[l][0].data()),
              step_y = Faces::loaded(fractions.step[l][1].data()),
              step_z = Faces::loaded(fractions.step[l][2].data()),
              first = Faces::loaded(fractions.first[l].data());
  for (int z = fractions.low[2][l]; z <= fractions.high[2][l]; ++z)
    for (int y = fractions.low[1][l]; y <= fractions.high[1][l]; ++y) {
      const Faces row = first + step_y * double(y) + step_z * double(z);
      const std::int32_t number = (z * bricks_per_side + y) * bricks_per_side;
      for (int x = fractions.low[0][l]; x <= fractions.high[0][l]; ++x)
        if (!any_less(Faces::filled(0.0), row + step_x * double(x))) bricks.push_back(number + x);
    }
}

template <Simd simd>
LEFORT_INLINE void add_all(const geometry::TriangleMesh& mesh, Index begin, Index end,
                           const BrickGrid& grid, double max_distance_mm, OverlapBudget& pairs,
                           TriangleBrickOverlaps& overlaps) {
  const double per_mm = 1.0 / (kSide * grid.cell_mm);
  Fractions fractions;
  for (auto& first : fractions.first) first.fill(-1.0);  // Unused faces are never exceeded.
  for (auto& steps : fractions.step)
    for (auto& step : steps) step.fill(0.0);
  static_assert(kUsedFaces <= kFaces);
  for (Index from = begin; from < end; from += Index(kBatch)) {
    std::array<std::array<Lanes, 3>, 3> lanes;  // By corner and axis.
    for (std::size_t l = 0; l < kBatch; ++l) {
      const Index t = std::min(from + Index(l), end - 1);
      for (int i = 0; i < 3; ++i) {
        const double* const p = mesh.corner(t, i).data();
        for (std::size_t k = 0; k < 3; ++k)
          lanes[std::size_t(i)][k][l] = p[k] - grid.origin_B.data()[k];
      }
    }
    std::array<Vectors<simd>, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto in_bricks = [&](std::size_t k) __attribute__((always_inline)) {
        return Doubles<simd>::loaded(lanes[i][k].data()) * per_mm + 1.0;
      };
      corners[i] = {in_bricks(0), in_bricks(1), in_bricks(2)};
    }
    prepare_fractions(corners, max_distance_mm * per_mm, grid.bricks_per_side, fractions);
    const auto count = std::size_t(std::min(Index(kBatch), end - from));
    std::int64_t in_boxes = 0;
    for (std::size_t l = 0; l < count; ++l) {
      std::int64_t box = 1;
      for (std::size_t k = 0; k < 3; ++k) box *= fractions.high[k][l] - fractions.low[k][l] + 1;
      in_boxes += box;
    }
    const bool fits = pairs.add(in_boxes);
    for (std::size_t l = 0; l < count; ++l) {
      if (fits) list_bricks<simd>(fractions, l, grid.bricks_per_side, overlaps.bricks);
      overlaps.ends.push_back(std::uint32_t(overlaps.bricks.size()));
    }
  }
}

#if defined(__x86_64__)
LEFORT_AVX512 void add_avx512(const geometry::TriangleMesh& mesh, Index begin, Index end,
                              const BrickGrid& grid, double max_distance_mm, OverlapBudget& pairs,
                              TriangleBrickOverlaps& overlaps) {
  add_all<Simd::kAvx512>(mesh, begin, end, grid, max_distance_mm, pairs, overlaps);
}
LEFORT_AVX2 void add_avx2(const geometry::TriangleMesh& mesh, Index begin, Index end,
                          const BrickGrid& grid, double max_distance_mm, OverlapBudget& pairs,
                          TriangleBrickOverlaps& overlaps) {
  add_all<Simd::kAvx2>(mesh, begin, end, grid, max_distance_mm, pairs, overlaps);
}
#endif

}  // namespace

TriangleBrickOverlaps triangle_brick_overlaps(const geometry::TriangleMesh& mesh, Index begin,
                                              Index end, const BrickGrid& grid,
                                              double max_distance_mm, OverlapBudget& pairs,
                                              Simd simd) {
  TriangleBrickOverlaps overlaps;
  overlaps.ends.reserve(std::size_t(end - begin));
#if defined(__x86_64__)
  if (simd == Simd::kAvx512) {
    add_avx512(mesh, begin, end, grid, max_distance_mm, pairs, overlaps);
    return overlaps;
  }
  if (simd == Simd::kAvx2) {
    add_avx2(mesh, begin, end, grid, max_distance_mm, pairs, overlaps);
    return overlaps;
  }
#endif
  add_all<Simd::kBaseline>(mesh, begin, end, grid, max_distance_mm, pairs, overlaps);
  return overlaps;
}

}  // namespace lefort::field
