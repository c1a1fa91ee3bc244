#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/tube_surface.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace lefort::geometry {
namespace {

TEST(TubeSurface, is_closed_with_the_volume_of_the_tube) {
  std::vector<Vec3> straight, arc;
  for (int n = 0; n <= 40; ++n) {
    straight.emplace_back(1.0, 0.5 * n, 2.0);
    const double angle = 0.04 * n;
    arc.emplace_back(20.0 * std::cos(angle), 20.0 * std::sin(angle), 5.0 * angle);
  }
  for (const auto& line : {straight, arc}) {
    const TriangleMesh tube = tube_surface(line, 1.5, 64);
    EXPECT_TRUE(is_closed(tube));
    double length_mm = 0.0;
    for (std::size_t n = 1; n < line.size(); ++n) length_mm += (line[n] - line[n - 1]).norm();
    const double volume_mm3 = std::numbers::pi * 1.5 * 1.5 * length_mm;
    EXPECT_NEAR(signed_volume_mm3(tube), volume_mm3, 0.01 * volume_mm3);
    EXPECT_EQ(tube.vertices[tube.vertices.size() - 1], line.back());
    EXPECT_EQ(tube.vertices[tube.vertices.size() - 2], line.front());
  }
}

}  // namespace
}  // namespace lefort::geometry
