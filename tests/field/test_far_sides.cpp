#include <lefort/field/far_sides.h>
#include <lefort/field/narrow_band.h>

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace lefort::field {
namespace {

constexpr int kResolution = 64;

/// Cube of kResolution cells of 1 mm around the origin, sampled to two cells.
SparseLattice sample_near(const geometry::TriangleMesh& mesh) {
  FieldFrame frame;
  frame.resolution = kResolution;
  frame.cell_mm = 1.0;
  frame.origin_B = Vec3::Constant(-0.5 * kResolution + 0.01);
  return sample_narrow_band(mesh, frame, 2.0, Progress::none()).value();
}

TEST(FarSides, AgreeWithTheWindingNumberEverywhere) {
  // A hollow ball, and a ball inside the hollow: out, in, out, in.
  const auto mesh = test::join(
      test::join(test::make_icosphere(29, 2), test::turn_inside_out(test::make_icosphere(20, 2))),
      test::make_icosphere(11, 2));
  const SidedDistances distances = fill_far_sides(sample_near(mesh), true);
  int absent = 0;
  for (int k = 0; k <= kResolution; k += 2)
    for (int j = 0; j <= kResolution; j += 3)
      for (int i = 0; i <= kResolution; i += 2) {
        const Vec3 p = Vec3(i, j, k) + Vec3::Constant(-0.5 * kResolution + 0.01);
        const bool inside = test::winding_number(mesh, p) > 0.5;
        if (distances.near.slot_of(distances.near.brick_of({i, j, k})) == SparseLattice::kNoBrick)
          ++absent;
        EXPECT_EQ(distances.at({i, j, k}) < 0.0F, inside) << p.transpose();
      }
  EXPECT_GT(absent, 100);
}

TEST(FarSides, OfAnOpenSurfaceAreUnknown) {
  const SidedDistances distances = fill_far_sides(sample_near(test::make_sheet(30, 2)), false);
  EXPECT_TRUE(std::isnan(distances.at({32, 32, 36})));  // In a brick of the band.
  EXPECT_TRUE(std::isnan(distances.at({2, 2, 2})));     // In none.
}

}  // namespace
}  // namespace lefort::field
