#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/combine_solids.h>
#include <lefort/mesh/cut_surface.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "support/shapes.h"

namespace lefort::mesh::test_combine_solids {
namespace {

using geometry::signed_volume_mm3;
using geometry::TriangleMesh;

const std::vector<Vec3> kHook{{0, 0, 5}, {4, 0, -3}, {4, 4, 0}, {2, 4, 1}, {2, 2, 0}, {0, 2, 9}};

TEST(CombineSolids, UnionAndIntersectionOfBoxesHaveTheirVolumes) {
  const TriangleMesh a = test::make_box({0, 0, 0}, {4, 4, 4}),
                     b = test::make_box({2, 1, 1}, {6, 3, 3});
  const auto both = intersect(a, b), either = unite(a, b);
  ASSERT_TRUE(both && either);
  EXPECT_NEAR(signed_volume_mm3(*both), 8.0, 1e-12);
  EXPECT_NEAR(signed_volume_mm3(*either), 64.0 + 8.0, 1e-12);
  EXPECT_TRUE(geometry::is_closed(*both) && geometry::is_closed(*either));
}

TEST(CombineSolids, EmptySurfaceIsTheNeutralElement) {
  const TriangleMesh a = test::make_box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(unite(a, {})->triangle_count(), 12);
  EXPECT_EQ(unite({}, a)->triangle_count(), 12);
  EXPECT_EQ(intersect(a, {})->triangle_count(), 0);
  EXPECT_EQ(intersect(a, test::make_box({5, 5, 5}, {6, 6, 6}))->triangle_count(), 0);
}

TEST(MakePrism, VolumeIsThePolygonsAreaTimesTheHeight) {
  for (const bool is_reversed : {false, true}) {
    std::vector<Vec3> curve = kHook;
    if (is_reversed) std::reverse(curve.begin(), curve.end());
    const auto prism = make_prism(curve, {0, 0, 2}, -1.0, 4.0);
    ASSERT_TRUE(prism) << prism.error().message;
    EXPECT_TRUE(geometry::is_closed(*prism));
    EXPECT_NEAR(signed_volume_mm3(*prism), (16.0 - 4.0) * 5.0, 1e-12);
    EXPECT_NEAR(geometry::bounding_box(*prism).min().z(), -1.0, 1e-12);
    EXPECT_NEAR(geometry::bounding_box(*prism).max().z(), 4.0, 1e-12);
  }
}

TEST(MakePrism, GrowsByTheKerfOnAllSides) {
  const std::vector<Vec3> square{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
  const auto grown = make_prism(square, {0, 0, 1}, 0.0, 1.0, 0.5);
  ASSERT_TRUE(grown);
  EXPECT_NEAR(signed_volume_mm3(*grown), 121.0, 1e-9);
}

TEST(MakePrism, IsExtrudedAlongTheDirection) {
  std::vector<Vec3> circle;
  for (int i = 0; i < 64; ++i) {
    const double u = 2.0 * std::numbers::pi * i / 64;
    circle.emplace_back(3.0 * std::cos(u), 7.0 * std::sin(2.0 * u), 3.0 * std::sin(u));
  }
  const auto prism = make_prism(circle, {0, -1, 0}, 0.0, 10.0);
  ASSERT_TRUE(prism) << prism.error().message;
  EXPECT_NEAR(geometry::bounding_box(*prism).min().y(), -10.0, 1e-12);
  EXPECT_NEAR(signed_volume_mm3(*prism), 32.0 * std::sin(2.0 * std::numbers::pi / 64) * 9.0 * 10.0,
              1e-9);
}

TEST(MakePrism, AcceptsCollinearCorners) {
  const std::vector<Vec3> square{{0, 0, 0},   {5, 0, 0},  {10, 0, 0},
                                 {10, 10, 0}, {5, 10, 0}, {0, 10, 0}};
  const auto prism = make_prism(square, {0, 0, 1}, 0.0, 1.0);
  ASSERT_TRUE(prism);
  EXPECT_TRUE(geometry::is_closed(*prism));
  EXPECT_NEAR(signed_volume_mm3(*prism), 100.0, 1e-9);
}

TEST(MakePrism, RejectsInvalidCurves) {
  const auto refuse = [](const std::vector<Vec3>& curve, const Vec3& direction, const char* words,
                         double grow_mm = 0.0) {
    const auto prism = make_prism(curve, direction, 0.0, 1.0, grow_mm);
    ASSERT_FALSE(prism) << words;
    EXPECT_EQ(prism.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(prism.error().message.find(words), std::string::npos) << prism.error().message;
  };
  refuse({{0, 0, 0}, {1, 0, 0}}, {0, 0, 1}, "has 2 points");
  refuse(kHook, {0, 0, 0}, "no length");
  refuse({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}}, {0, 0, 1}, "crosses or touches itself");
  refuse({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {0, 0, 1}, "crosses or touches itself");
  refuse({{0, 0, 0}, {1, 0, 0}, {1, std::nan(""), 0}}, {0, 0, 1}, "point 2 is not finite");
  refuse(kHook, {0, 1, 0}, "crosses or touches itself");
  // A notch that closes when the sides move outwards.
  refuse({{0, 0, 0},
          {10, 0, 0},
          {10, 10, 0},
          {5.5, 10, 0},
          {5.5, 2, 0},
          {4.5, 2, 0},
          {4.5, 10, 0},
          {0, 10, 0}},
         {0, 0, 1}, "widened by the kerf", 1.0);
}

TEST(CutSurfaceBySolid, SplitsABallIntoExactVolumes) {
  const TriangleMesh ball = test::make_icosphere(10.0, 4);
  const auto prism =
      make_prism(std::vector<Vec3>{{-3, -20, -3}, {3, -20, -3}, {3, -20, 3}, {-3, -20, 3}},
                 {0, 1, 0}, -25.0, 0.0)
          .value();
  const auto cut = cut_surface(ball, prism);
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_TRUE(geometry::is_closed(cut->inside) && geometry::is_closed(cut->outside));
  EXPECT_NEAR(cut->inside_volume_mm3 + cut->outside_volume_mm3, signed_volume_mm3(ball), 1e-6);
  EXPECT_GT(cut->inside_volume_mm3, 36.0 * 9.0);
  EXPECT_LT(cut->inside_volume_mm3, 36.0 * 10.0);
  const auto missed = cut_surface(ball, TriangleMesh{});
  ASSERT_TRUE(missed);
  EXPECT_TRUE(missed->inside.triangles.empty());
}

}  // namespace
}  // namespace lefort::mesh::test_combine_solids
