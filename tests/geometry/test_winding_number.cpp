#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <utility>

#include "support/shapes.h"

namespace lefort::geometry::test_winding_number {
namespace {

TEST(WindingNumber, IsOneInsideAndZeroOutside) {
  const TriangleMesh ball = test::make_icosphere(10.0, 2);
  EXPECT_NEAR(winding_number(ball, {1.0, -2.0, 3.0}), 1.0, 1e-12);
  EXPECT_NEAR(winding_number(ball, {11.0, 0.0, 0.0}), 0.0, 1e-12);
}

TEST(WindingNumber, CountsShellsAndTheirOrientation) {
  const TriangleMesh outer = test::make_icosphere(10.0, 2);
  TriangleMesh inner = test::make_icosphere(5.0, 2);
  EXPECT_NEAR(winding_number(test::join(outer, inner), Vec3::Zero()), 2.0, 1e-12);
  for (auto& triangle : inner.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_NEAR(winding_number(test::join(outer, inner), Vec3::Zero()), 0.0, 1e-12);
}

TEST(WindingNumber, OfOneTriangleIsItsSolidAngle) {
  // A triangle of an octant, seen from the origin, covers an eighth of the sphere.
  TriangleMesh octant;
  octant.vertices = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  octant.triangles = {{0, 1, 2}};
  EXPECT_NEAR(winding_number(octant, Vec3::Zero()), 0.125, 1e-12);
}

}  // namespace
}  // namespace lefort::geometry::test_winding_number
