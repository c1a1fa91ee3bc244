#include <lefort/field/build/band_sampler.h>
#include <lefort/field/sign/outside_band.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace lefort::field::test_outside_band {
namespace {

constexpr int kResolution = 64;

/// Cube of kResolution cells of 1 mm around the origin.
FieldFrame cube() {
  FieldFrame frame;
  frame.resolution = kResolution;
  frame.cell_mm = 1.0;
  frame.origin_B = Vec3::Constant(-0.5 * kResolution + 0.01);
  return frame;
}

/// The same with a band of two cells.
FieldFrame narrow() {
  FieldFrame frame = cube();
  frame.band_mm = 2.0;
  return frame;
}

/// Sampled up to two cells.
SparseLattice sample_near(const geometry::TriangleMesh& mesh) {
  return sample_narrow_band(prepare_surface(mesh).value(), cube(), 2.0, nullptr, Progress::none())
      .value();
}

TEST(OutsideBand, AgreeWithTheWindingNumberEverywhere) {
  // A hollow ball, and a ball inside the cavity: outside, inside, outside, inside.
  const auto mesh = test::join(
      test::join(test::make_icosphere(29, 2), test::turn_inside_out(test::make_icosphere(20, 2))),
      test::make_icosphere(11, 2));
  const WindingScanlines winding(mesh, cube());
  const SignedDistances distances = fill_outside_band(sample_near(mesh), narrow(), &winding);
  int absent = 0;
  for (int k = 0; k <= kResolution; k += 2)
    for (int j = 0; j <= kResolution; j += 3)
      for (int i = 0; i <= kResolution; i += 2) {
        const Vec3 p = Vec3(i, j, k) + Vec3::Constant(-0.5 * kResolution + 0.01);
        const bool inside = geometry::winding_number(mesh, p) > 0.5;
        if (distances.near.slot_of(distances.near.brick_of({i, j, k})) == SparseLattice::kNoBrick)
          ++absent;
        EXPECT_EQ(distances.at({i, j, k}) < 0.0F, inside) << p.transpose();
      }
  EXPECT_GT(absent, 100);
}

TEST(OutsideBand, OfAnOpenSurfaceAreUnknown) {
  const SignedDistances distances =
      fill_outside_band(sample_near(test::make_sheet(30, 2)), narrow(), nullptr);
  EXPECT_TRUE(std::isnan(distances.at({32, 32, 36})));  // In a brick of the band.
  EXPECT_TRUE(std::isnan(distances.at({2, 2, 2})));     // In no brick.
}

TEST(OutsideBand, MatchTheWindingNumberWhereSurfacesIntersect) {
  // Inside one ball and outside the other: known points near the surface of the other are outside,
  // which must not spread to unsampled points.
  const auto mesh = test::join(test::make_icosphere(16, 3, Vec3(-8, 0.3, 0.1)),
                               test::make_icosphere(16, 3, Vec3(8, -0.2, 0)));
  const FieldFrame frame = cube();
  const WindingScanlines winding(mesh, frame);
  const SignedDistances distances = fill_outside_band(sample_near(mesh), narrow(), &winding);
  int contested = 0;
  for (int k = 0; k <= kResolution; ++k)
    for (int j = 0; j <= kResolution; ++j)
      for (int i = 0; i <= kResolution; ++i) {
        const float d = distances.at({i, j, k});
        if (std::isfinite(d)) continue;
        const Vec3 p = frame.origin_B + Vec3(i, j, k);
        const double turns = geometry::winding_number(mesh, p);
        ASSERT_EQ(d<0.0F, turns> 0.5) << p.transpose();
        contested += turns > 1.5 ? 1 : 0;
      }
  EXPECT_GT(contested, 100);
}

}  // namespace
}  // namespace lefort::field::test_outside_band
