/// \file
/// Crossings of parallel lines with bodies of known shape.
#include <lefort/geometry/surface_crossings.h>

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace lefort::geometry::test_surface_crossings {
namespace {

const Box3 kWindow(Vec3(-30, -30, -30), Vec3(30, 30, 30));

TEST(SurfaceCrossings, OfASphereEnterAndLeaveIt) {
  const TriangleMesh sphere = test::make_icosphere(20.0, 5, {1, 2, 3});
  for (int axis = 0; axis < 3; ++axis) {
    const SurfaceCrossings lines(sphere, axis, kWindow, 0.5);
    for (const Vec3& at : {Vec3(1, 2, 3), Vec3(10, 11, 12), Vec3(-8, -5, -2)}) {
      ASSERT_EQ(lines.crossings(at).size(), 2U);
      const Vec3 first = *lines.first(at), last = *lines.last(at);
      EXPECT_LT(first[axis], last[axis]);
      for (const Vec3& p : {first, last}) {
        EXPECT_NEAR((p - Vec3(1, 2, 3)).norm(), 20.0, 0.05);
        for (int other = 0; other < 3; ++other)
          if (other != axis) {
            EXPECT_LE(std::abs(p[other] - at[other]), 0.26 + 1e-9);
          }
      }
    }
    EXPECT_TRUE(lines.crossings({25, 25, 25}).empty());
    EXPECT_FALSE(lines.first({200, 0, 0}) && axis != 0);
  }
}

/// No line is lost or counted twice at edges and vertices, even if they lie on round coordinates.
TEST(SurfaceCrossings, OfABoxAreTwoForEveryLine) {
  const TriangleMesh box = test::make_box({-10, -8, -6}, {10, 8, 6});
  for (int axis = 0; axis < 3; ++axis) {
    const SurfaceCrossings lines(box, axis, kWindow, 0.5);
    Index inside = 0;
    for (double x = -9.75; x < 10; x += 0.5)
      for (double y = -7.75; y < 8; y += 0.5)
        for (double z = -5.75; z < 6; z += 0.5) {
          ASSERT_EQ(lines.crossings({x, y, z}).size(), 2U);
          ++inside;
        }
    EXPECT_EQ(inside, 40 * 32 * 24);
    const auto front = lines.first_within(kWindow), back = lines.last_within(kWindow);
    const std::array<std::size_t, 3> expected{32 * 24, 40 * 24, 40 * 32};
    EXPECT_EQ(front.size(), expected[std::size_t(axis)]);
    EXPECT_EQ(back.size(), expected[std::size_t(axis)]);
    for (const Vec3& p : front) EXPECT_LT(p[axis], 0.0);
  }
}

TEST(SurfaceCrossings, OmitCrossingsOutsideTheWindow) {
  const TriangleMesh box = test::make_box({-10, -8, -6}, {10, 8, 6});
  const SurfaceCrossings lines(box, 1, {Vec3(-5, 0, -5), Vec3(5, 30, 5)}, 0.5);
  EXPECT_EQ(lines.crossings({0, 0, 0}).size(), 1U);
  EXPECT_NEAR(lines.first({0, 0, 0})->y(), 8.0, 1e-9);
}

}  // namespace
}  // namespace lefort::geometry::test_surface_crossings
