#include <lefort/geometry/plane_section.h>

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <numbers>

#include "support/shapes.h"

namespace lefort::geometry::test_plane_section {
namespace {

double length_of(const std::vector<std::array<Vec3, 2>>& pieces) {
  double sum = 0.0;
  for (const auto& [from, to] : pieces) sum += (to - from).norm();
  return sum;
}

/// Number of segment ends at a point beyond two.
bool is_closed_line(const std::vector<std::array<Vec3, 2>>& pieces) {
  std::map<std::array<double, 3>, int> ends;
  for (const auto& piece : pieces)
    for (const Vec3& p : piece) ++ends[{p.x(), p.y(), p.z()}];
  for (const auto& [at, count] : ends)
    if (count % 2 != 0) return false;
  return true;
}

TEST(PlaneSection, OfABoxIsARectangle) {
  const TriangleMesh box = test::make_box(Vec3(-1, -2, -3), Vec3(4, 5, 6));
  EXPECT_NEAR(length_of(plane_section(box, 0, 0.3)), 2 * (7 + 9), 1e-12);
  EXPECT_NEAR(length_of(plane_section(box, 1, 0.3)), 2 * (5 + 9), 1e-12);
  EXPECT_NEAR(length_of(plane_section(box, 2, 0.3)), 2 * (5 + 7), 1e-12);
  EXPECT_TRUE(plane_section(box, 2, 7.0).empty());
  EXPECT_TRUE(plane_section(box, 2, -3.5).empty());
}

TEST(PlaneSection, LiesInThePlaneAndOnTheSurface) {
  const TriangleMesh ball = test::make_icosphere(10, 4, Vec3(1, 2, 3));
  const auto circle = plane_section(ball, 1, 6.0);
  for (const auto& piece : circle)
    for (const Vec3& p : piece) {
      EXPECT_EQ(p.y(), 6.0);
      EXPECT_NEAR((p - Vec3(1, 2, 3)).norm(), 10.0, 0.03);
    }
  EXPECT_NEAR(length_of(circle), 2 * std::numbers::pi * std::sqrt(84.0), 0.2);
}

TEST(PlaneSection, OfAClosedSurfaceIsClosedEvenThroughVertices) {
  // Vertices of the ball lie at z = 0, and faces of the box in its planes.
  EXPECT_TRUE(is_closed_line(plane_section(test::make_icosphere(10, 3), 2, 0.0)));
  EXPECT_FALSE(plane_section(test::make_icosphere(10, 3), 2, 0.0).empty());
  const TriangleMesh box = test::make_box(Vec3(-1, -2, -3), Vec3(4, 5, 6));
  EXPECT_TRUE(is_closed_line(plane_section(box, 2, 6.0)));
  EXPECT_TRUE(plane_section(box, 2, -3.0).empty());  // All of it lies in or above the plane.
}

TEST(PlaneSection, OfATriangleInThePlaneIsEmpty) {
  EXPECT_TRUE(plane_section(test::make_sheet(10, 2), 2, 0.0).empty());
}

}  // namespace
}  // namespace lefort::geometry::test_plane_section
