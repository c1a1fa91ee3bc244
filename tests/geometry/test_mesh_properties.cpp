#include <lefort/geometry/mesh_properties.h>

#include <gtest/gtest.h>

#include <limits>

#include "support/shapes.h"

namespace lefort::geometry::test_mesh_properties {
namespace {

using test::make_box;

const TriangleMesh kBox = make_box(Vec3(1, 2, 3), Vec3(3, 5, 7));

TEST(MeshProperties, BoxHasItsAreaVolumeAndBounds) {
  EXPECT_DOUBLE_EQ(area_mm2(kBox), 2 * (2 * 3 + 3 * 4 + 2 * 4));
  EXPECT_DOUBLE_EQ(signed_volume_mm3(kBox), 24.0);
  EXPECT_DOUBLE_EQ(signed_volume_mm3(test::turn_inside_out(kBox)), -24.0);
  EXPECT_EQ(bounding_box(kBox).min(), Vec3(1, 2, 3));
  EXPECT_EQ(bounding_box(kBox).max(), Vec3(3, 5, 7));
}

TEST(MeshProperties, FineTorusApproachesPappus) {
  const TriangleMesh torus = test::make_torus(10, 3, 400, 200);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(area_mm2(torus), 4 * pi * pi * 10 * 3, 0.3);
  EXPECT_NEAR(signed_volume_mm3(torus), 2 * pi * pi * 10 * 9, 0.6);
}

TEST(MeshProperties, VolumeDoesNotDependOnTheOrigin) {
  const RigidTransform far(Eigen::Translation3d(1e5, -2e5, 3e5));
  EXPECT_NEAR(signed_volume_mm3(test::moved(kBox, far)), 24.0, 1e-8);
}

TEST(MeshProperties, UnusedVerticesAreIgnored) {
  TriangleMesh mesh = kBox;
  mesh.vertices.emplace_back(100, 100, 100);
  EXPECT_EQ(bounding_box(mesh).max(), Vec3(3, 5, 7));
  EXPECT_EQ(euler_characteristic(mesh), 2);
}

TEST(MeshProperties, EulerCharacteristicOfSphereTorusAndSheet) {
  EXPECT_EQ(euler_characteristic(test::make_icosphere(1, 2)), 2);
  EXPECT_EQ(euler_characteristic(test::make_torus(5, 1, 9, 7)), 0);
  EXPECT_EQ(euler_characteristic(test::make_sheet(1, 4)), 1);
}

TEST(MeshProperties, ClosedShapesAreClosed) {
  EXPECT_TRUE(is_closed(kBox));
  EXPECT_TRUE(is_closed(test::make_icosphere(1, 3)));
  EXPECT_TRUE(is_closed(test::make_torus(5, 1, 9, 7)));
  EXPECT_TRUE(is_closed(test::make_spike(1, 3, 5)));
  EXPECT_TRUE(is_closed(test::with_cap(kBox, 3, 1)));
}

TEST(MeshProperties, NamesTheFirstOpenEdge) {
  TriangleMesh open = kBox;
  open.triangles.erase(open.triangles.begin());  // Was (0, 2, 3).
  const auto edge = first_open_edge(open);
  ASSERT_TRUE(edge);
  EXPECT_EQ(describe(*edge), "edge 0-2 has 1 triangle");
  EXPECT_FALSE(is_closed(open));
}

TEST(MeshProperties, NamesAnInconsistentEdge) {
  TriangleMesh twisted = kBox;
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  const auto edge = first_open_edge(twisted);
  ASSERT_TRUE(edge);
  EXPECT_EQ(describe(*edge), "edge 0-2 has 2 triangles of opposite orientation");
}

TEST(MeshProperties, BoxesThatTouchAlongAnEdgeEncloseAVolumeButAreNotManifold) {
  const TriangleMesh two = weld_vertices(
      test::join(make_box(Vec3(0, 0, 0), Vec3(1, 1, 1)), make_box(Vec3(1, 1, 0), Vec3(2, 2, 1))));
  ASSERT_EQ(two.vertex_count(), 14);
  EXPECT_EQ(first_open_edge(two).value().forward, 2);
  EXPECT_FALSE(first_unbalanced_edge(two));
  EXPECT_TRUE(first_unbalanced_edge(test::make_sheet(1, 2)));
}

TEST(MeshProperties, ComponentsAreNumberedAsTheyAppear) {
  const TriangleMesh two = test::join(test::make_icosphere(1, 1), kBox);
  const Components parts = connected_components(two);
  EXPECT_EQ(parts.count, 2);
  EXPECT_EQ(parts.of_triangle.front(), 0);
  EXPECT_EQ(parts.of_triangle.back(), 1);
  EXPECT_EQ(std::count(parts.of_triangle.begin(), parts.of_triangle.end(), 1), 12);
}

TEST(MeshProperties, KeepsTheComponentsRequested) {
  const TriangleMesh two = test::join(test::make_icosphere(1, 1), kBox);
  const TriangleMesh large =
      keep_components(two, [](const TriangleMesh& part) { return signed_volume_mm3(part) > 10.0; });
  EXPECT_EQ(large.vertices, kBox.vertices);
  EXPECT_EQ(large.triangles, kBox.triangles);
  EXPECT_TRUE(keep_components(two, [](const TriangleMesh&) { return false; }).triangles.empty());
}

TEST(MeshProperties, WeldingASoupRestoresTheSurface) {
  const TriangleMesh soup = test::unwelded(kBox);
  EXPECT_EQ(soup.vertex_count(), 36);
  EXPECT_FALSE(is_closed(soup));
  const TriangleMesh welded = weld_vertices(soup);
  EXPECT_EQ(welded.vertex_count(), 8);
  EXPECT_TRUE(is_closed(welded));
  EXPECT_DOUBLE_EQ(signed_volume_mm3(welded), 24.0);
}

TEST(MeshProperties, WeldingDropsTrianglesThatCollapseAndTreatsNegativeZeroAsZero) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  const TriangleMesh welded = weld_vertices(mesh);
  EXPECT_EQ(welded.vertex_count(), 3);
  EXPECT_EQ(welded.triangle_count(), 1);
}

TEST(CheckSurface, AcceptsASurface) { EXPECT_TRUE(check_surface(kBox)); }

TEST(CheckSurface, RejectsInvalidSurfacesAndNamesTheReason) {
  const auto complaint = [](const TriangleMesh& mesh) {
    const auto result = check_surface(mesh);
    EXPECT_EQ(result.error().code, ErrorCode::kMeshInvalid);
    return result.error().message;
  };
  EXPECT_NE(complaint({}).find("no triangle"), std::string::npos);

  TriangleMesh nan = kBox;
  nan.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint(nan).find("vertex 3"), std::string::npos);
  TriangleMesh far = kBox;
  far.vertices[5].z() = 1e7;
  EXPECT_NE(complaint(far).find("vertex 5"), std::string::npos);
  far.vertices[5].z() = std::numeric_limits<double>::infinity();
  EXPECT_NE(complaint(far).find("vertex 5"), std::string::npos);

  TriangleMesh wild = kBox;
  wild.triangles[4][1] = 8;
  EXPECT_NE(complaint(wild).find("triangle 4 of the surface names vertex 8"), std::string::npos);
  wild.triangles[4][1] = -1;
  EXPECT_NE(complaint(wild).find("names vertex -1"), std::string::npos);
}

}  // namespace
}  // namespace lefort::geometry::test_mesh_properties
