#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/repair_surface.h>

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

#include "support/shapes.h"

namespace lefort::mesh::test_repair_surface {
namespace {

using geometry::signed_volume_mm3;
using geometry::TriangleMesh;

TEST(RepairSurface, DoesNotChangeAValidSurface) {
  const TriangleMesh torus = test::make_torus(10.0, 3.0, 24, 12);
  const auto repaired = repair_surface(torus);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_EQ(repaired->triangle_count(), torus.triangle_count());
  EXPECT_EQ(signed_volume_mm3(*repaired), signed_volume_mm3(torus));
}

TEST(RepairSurface, StitchesATriangleSoup) {
  const auto repaired = repair_surface(test::unwelded(test::make_icosphere(5.0, 2)));
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_TRUE(geometry::is_closed(*repaired));
  EXPECT_EQ(repaired->vertex_count(), 162);
}

TEST(RepairSurface, ReversesAnInvertedSurface) {
  const auto repaired = repair_surface(test::turn_inside_out(test::make_icosphere(5.0, 2)));
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_NEAR(signed_volume_mm3(*repaired), signed_volume_mm3(test::make_icosphere(5.0, 2)), 1e-9);
}

TEST(RepairSurface, OrientsInconsistentTriangles) {
  const TriangleMesh sphere = test::make_icosphere(5.0, 2);
  TriangleMesh mixed = sphere;
  std::mt19937 random(7);
  for (auto& [a, b, c] : mixed.triangles)
    if (random() % 2 == 0) std::swap(b, c);
  const auto repaired = repair_surface(mixed);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_TRUE(geometry::is_closed(*repaired));
  EXPECT_NEAR(signed_volume_mm3(*repaired), signed_volume_mm3(sphere), 1e-9);
}

TEST(RepairSurface, KeepsCavities) {
  const TriangleMesh shell =
      test::join(test::make_box({0, 0, 0}, {4, 4, 4}),
                 test::turn_inside_out(test::make_box({1, 1, 1}, {3, 3, 3})));
  const auto repaired = repair_surface(shell);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_NEAR(signed_volume_mm3(*repaired), 56.0, 1e-12);
}

TEST(RepairSurface, SplitsAVertexWhereTheSurfaceTouchesItself) {
  const TriangleMesh touching = geometry::weld_vertices(
      test::join(test::make_box({0, 0, 0}, {1, 1, 1}), test::make_box({1, 1, 1}, {2, 2, 2})));
  ASSERT_EQ(touching.vertex_count(), 15);
  const auto repaired = repair_surface(touching);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_EQ(repaired->vertex_count(), 16);
  EXPECT_NEAR(signed_volume_mm3(*repaired), 2.0, 1e-12);
}

TEST(RepairSurface, SplitsAnEdgeWhereTheSurfaceTouchesItself) {
  const TriangleMesh touching = geometry::weld_vertices(
      test::join(test::make_box({0, 0, 0}, {1, 1, 1}), test::make_box({1, 1, 0}, {2, 2, 1})));
  ASSERT_FALSE(geometry::is_closed(touching));
  const auto repaired = repair_surface(touching);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_TRUE(geometry::is_closed(*repaired));
  EXPECT_NEAR(signed_volume_mm3(*repaired), 2.0, 1e-12);
}

TEST(RepairSurface, RemovesTrianglesWithoutAreaAndDuplicates) {
  TriangleMesh mesh = test::with_cap(test::make_icosphere(5.0, 2), 17, 1);
  const double volume_mm3 = signed_volume_mm3(mesh);
  mesh.triangles.push_back(mesh.triangles[3]);
  mesh.triangles.push_back({5, 5, 9});
  const auto repaired = repair_surface(mesh);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_TRUE(geometry::is_closed(*repaired));
  EXPECT_NEAR(signed_volume_mm3(*repaired), volume_mm3, 1e-9);
  for (Index t = 0; t < repaired->triangle_count(); ++t) {
    const Vec3& a = repaired->corner(t, 0);
    EXPECT_GT((repaired->corner(t, 1) - a).cross(repaired->corner(t, 2) - a).norm(), 1e-6);
  }
}

void expect_refused(const TriangleMesh& mesh, const std::string& words) {
  const auto repaired = repair_surface(mesh);
  ASSERT_FALSE(repaired);
  EXPECT_EQ(repaired.error().code, ErrorCode::kMeshInvalid);
  EXPECT_NE(repaired.error().message.find(words), std::string::npos) << repaired.error().message;
}

TEST(RepairSurface, RejectsAnOpenSurfaceAndReportsAnEdge) {
  TriangleMesh box = test::make_box({0, 0, 0}, {4, 4, 4});
  box.triangles.pop_back();
  expect_refused(box, "the surface is open: edge ");
  expect_refused(box, " has 1 triangle at (4.00, 0.00, 0.00) mm");
}

TEST(RepairSurface, RejectsInvalidSurfaces) {
  expect_refused({}, "");
  TriangleMesh box = test::make_box({0, 0, 0}, {4, 4, 4});
  box.vertices[2].x() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(box, "");
  box = test::make_box({0, 0, 0}, {4, 4, 4});
  box.triangles[0][1] = 99;
  expect_refused(box, "");
  expect_refused(
      test::join(test::make_sheet(3.0, 2), test::turn_inside_out(test::make_sheet(3.0, 2))), "");
}

TEST(RepairSurface, SurvivesRandomTriangles) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 50; ++trial) {
    TriangleMesh mesh;
    for (int v = 0; v < 8; ++v)
      mesh.vertices.emplace_back(random() % 3, random() % 3, random() % 3);
    for (int t = 0; t < 30; ++t)
      mesh.triangles.push_back(
          {std::int32_t(random() % 8), std::int32_t(random() % 8), std::int32_t(random() % 8)});
    const auto repaired = repair_surface(mesh);
    EXPECT_TRUE(!repaired || geometry::is_closed(*repaired)) << "trial " << trial;
  }
}

}  // namespace
}  // namespace lefort::mesh::test_repair_surface
