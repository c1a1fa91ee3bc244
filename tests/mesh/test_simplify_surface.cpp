#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/self_intersections.h>
#include <lefort/mesh/simplify_surface.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/shapes.h"

namespace lefort::mesh::test_simplify_surface {
namespace {

using geometry::TriangleMesh;

TEST(SimplifySurface, ReachesTheRequestedNumberAndKeepsTheShape) {
  const TriangleMesh fine = test::make_icosphere(30.0, 5);
  const auto coarse = simplify_surface(fine, 2000);
  ASSERT_TRUE(coarse) << coarse.error().message;
  EXPECT_LE(coarse->triangle_count(), 2000);
  EXPECT_GT(coarse->triangle_count(), 1990);
  EXPECT_TRUE(geometry::is_closed(*coarse));
  EXPECT_EQ(geometry::euler_characteristic(*coarse), 2);
  EXPECT_EQ(count_self_intersections(*coarse).value(), 0);
  // 2000 triangles on a sphere of 30 mm have sides of 3.6 mm and circumcircles of 2.1 mm, which lie
  // 0.072 mm deep.
  constexpr double kSag_mm = 0.072;
  EXPECT_NEAR(geometry::signed_volume_mm3(*coarse), geometry::signed_volume_mm3(fine),
              kSag_mm * geometry::area_mm2(fine));
  for (const Vec3& v : coarse->vertices) EXPECT_NEAR(v.norm(), 30.0, kSag_mm);
}

/// A box of many triangles needs only twelve.
TEST(SimplifySurface, KeepsEdgesAndSimplifiesPlanes) {
  TriangleMesh fine = test::make_box({0, 0, 0}, {20, 20, 20});
  for (int round = 0; round < 4; ++round) {
    TriangleMesh finer{fine.vertices, {}};
    for (const auto& [a, b, c] : fine.triangles) {
      const auto middle = std::int32_t(finer.vertices.size());
      finer.vertices.push_back((fine.vertices[std::size_t(a)] + fine.vertices[std::size_t(b)] +
                                fine.vertices[std::size_t(c)]) /
                               3.0);
      finer.triangles.insert(finer.triangles.end(),
                             {{a, b, middle}, {b, c, middle}, {c, a, middle}});
    }
    fine = finer;
  }
  const auto coarse = simplify_surface(fine, 12);
  ASSERT_TRUE(coarse) << coarse.error().message;
  EXPECT_LE(coarse->triangle_count(), 12);
  EXPECT_NEAR(geometry::signed_volume_mm3(*coarse), 8000.0, 1e-6);
}

TEST(SimplifySurface, SameInputSameBits) {
  const TriangleMesh fine = test::make_torus(20.0, 6.0, 60, 40);
  const auto one = simplify_surface(fine, 800).value(), other = simplify_surface(fine, 800).value();
  EXPECT_EQ(one.vertices, other.vertices);
  EXPECT_EQ(one.triangles, other.triangles);
  EXPECT_EQ(geometry::euler_characteristic(one), 0) << "still a torus";
}

TEST(SimplifySurface, DoesNotChangeACoarseSurface) {
  const TriangleMesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(simplify_surface(box, 100)->triangle_count(), 12);
}

TEST(SimplifySurface, RejectsOpenSurfacesAndTooFewTriangles) {
  EXPECT_EQ(simplify_surface(test::make_sheet(1.0, 4), 10).error().code, ErrorCode::kMeshInvalid);
  EXPECT_EQ(simplify_surface(test::make_icosphere(1.0, 2), 3).error().code,
            ErrorCode::kInvalidArgument);
}

TEST(SimplifySurface, CanBeStopped) {
  struct Stop : Progress {
    bool stop_requested() const override { return true; }
  } stop;
  EXPECT_EQ(simplify_surface(test::make_icosphere(10.0, 5), 100, stop).error().code,
            ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::mesh::test_simplify_surface
