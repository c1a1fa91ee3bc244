#include <lefort/field/build/triangle_brick_overlaps.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/geometry/closest_point.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "field/brute_force.h"
#include "support/shapes.h"
#include "support/ugly_mesh.h"

namespace lefort::field::test_triangle_brick_overlaps {
namespace {

using geometry::TriangleMesh;

constexpr int kResolution = 32;
constexpr std::int64_t kMany = 1 << 30;

/// 32 cells of 0.1 mm around soups of about 2 mm.
FieldFrame frame() {
  FieldFrame frame;
  frame.resolution = kResolution;
  frame.cell_mm = 0.1;
  frame.origin_B = Vec3(-1.63, -1.58, -1.6);
  return frame;
}

BrickGrid grid() {
  return {frame().origin_B, frame().cell_mm, SparseLattice::bricks_per_side(kResolution)};
}

std::vector<TriangleMesh> soups() {
  std::vector<TriangleMesh> soups;
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::mt19937 random(seed);
    soups.push_back(test::make_soup(random));
    test::spoil(soups.back(), random);
  }
  return soups;
}

std::vector<std::int32_t> bricks_of(const TriangleBrickOverlaps& overlaps, std::size_t t) {
  const auto first = overlaps.bricks.begin();
  return {first + (t == 0 ? 0 : overlaps.ends[t - 1]), first + overlaps.ends[t]};
}

TEST(TriangleBrickOverlaps, ContainEveryPointWithinTheDistanceOfATriangle) {
  const double max_distance_mm = 3 * frame().cell_mm;
  Index listed = 0, in_boxes = 0;
  for (const TriangleMesh& mesh : soups()) {
    OverlapBudget pairs(kMany);
    const TriangleBrickOverlaps overlaps =
        triangle_brick_overlaps(mesh, 0, mesh.triangle_count(), grid(), max_distance_mm, pairs);
    ASSERT_EQ(Index(overlaps.ends.size()), mesh.triangle_count());
    listed += Index(overlaps.bricks.size());
    in_boxes += pairs.count();
    const SparseLattice lattice(kResolution, {}, 0.0F);
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
      const std::vector<std::int32_t> bricks = bricks_of(overlaps, std::size_t(t));
      ASSERT_TRUE(std::is_sorted(bricks.begin(), bricks.end()));
      for (int k = -2; k <= kResolution + 2; ++k)
        for (int j = -2; j <= kResolution + 2; ++j)
          for (int i = -2; i <= kResolution + 2; ++i) {
            const Vec3 p = test::position_of(frame(), i, j, k);
            const double squared = geometry::closest_point_on_triangle(
                                       p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))
                                       .squared_distance_mm2;
            if (squared > max_distance_mm * max_distance_mm * (1 - 1e-9)) continue;
            ASSERT_TRUE(
                std::binary_search(bricks.begin(), bricks.end(), lattice.brick_of({i, j, k})))
                << t << ": " << p.transpose();
          }
    }
  }
  EXPECT_LT(listed, in_boxes * 9 / 10);  // Not only boxes are tested.
}

TEST(TriangleBrickOverlaps, AreTheSameForAPartOfTheTrianglesAndEveryProcessor) {
  for (const TriangleMesh& mesh : soups()) {
    OverlapBudget pairs(kMany);
    const TriangleBrickOverlaps all = triangle_brick_overlaps(mesh, 0, mesh.triangle_count(),
                                                              grid(), 0.25, pairs, Simd::kBaseline);
    for (const Simd simd : {Simd::kBaseline, Simd::kAvx2, Simd::kAvx512}) {
      if (simd > best_simd()) continue;
      for (Index t = 0; t < mesh.triangle_count(); ++t) {
        const TriangleBrickOverlaps one =
            triangle_brick_overlaps(mesh, t, t + 1, grid(), 0.25, pairs, simd);
        ASSERT_EQ(one.bricks, bricks_of(all, std::size_t(t)));
      }
      EXPECT_EQ(
          triangle_brick_overlaps(mesh, 0, mesh.triangle_count(), grid(), 0.25, pairs, simd).bricks,
          all.bricks);
    }
  }
}

TEST(TriangleBrickOverlaps, AreCountedButNotListedIfThereAreTooMany) {
  const TriangleMesh mesh = test::make_icosphere(1.0, 3);
  OverlapBudget enough(kMany);
  (void)triangle_brick_overlaps(mesh, 0, mesh.triangle_count(), grid(), 0.3, enough);
  EXPECT_FALSE(enough.too_many());

  OverlapBudget few(10);
  const TriangleBrickOverlaps overlaps =
      triangle_brick_overlaps(mesh, 0, mesh.triangle_count(), grid(), 0.3, few);
  EXPECT_TRUE(few.too_many());
  EXPECT_EQ(few.count(), enough.count());
  EXPECT_LE(overlaps.bricks.size(), 10U);
}

}  // namespace
}  // namespace lefort::field::test_triangle_brick_overlaps
