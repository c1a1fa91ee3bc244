#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/box_grid.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_boundary_faces {
namespace {

geometry::TriangleMesh surface_of(const VolumeMesh& mesh) {
  geometry::TriangleMesh surface;
  surface.vertices = mesh.nodes_L;
  surface.triangles = triangles_of(boundary_faces(mesh));
  return surface;
}

TEST(BoundaryFaces, TetrahedronHasFourOutwardFaces) {
  const auto surface = surface_of(test::regular_tet());
  EXPECT_EQ(surface.triangle_count(), 4);
  EXPECT_TRUE(geometry::is_closed(surface));
  EXPECT_NEAR(geometry::signed_volume_mm3(surface), 1.0 / (6.0 * std::sqrt(2.0)), 1e-15);
}

TEST(BoundaryFaces, BoxFacesEncloseItsVolumeAndUseEachEdgeTwice) {
  const auto surface = surface_of(test::cube_of_tets(3));
  EXPECT_EQ(surface.triangle_count(), 6 * 9 * 2);
  EXPECT_TRUE(geometry::is_closed(surface));
  EXPECT_NEAR(geometry::signed_volume_mm3(surface), 27.0, 1e-12);
  EXPECT_NEAR(geometry::area_mm2(surface), 54.0, 1e-12);
}

/// Sums over faces use this order: the last bits of results depend on it.
TEST(BoundaryFaces, TetrahedronFacesAreOppositeToTheirCornersInOrder) {
  const std::vector<Face3> expected{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  EXPECT_EQ(triangles_of(boundary_faces(test::regular_tet())), expected);
}

TEST(BoundaryFaces, QuadrilateralAndTwoTrianglesAreAllBoundary) {
  VolumeMesh mesh = make_box(ElementShape::kHex8, {2, 1, 1}, Vec3::Ones());
  const auto joined = boundary_faces(mesh).size();
  VolumeMesh tets = make_box(ElementShape::kTet4, {2, 1, 1}, Vec3::Ones());
  mesh.blocks[0].nodes.resize(8);
  mesh.blocks[0].region.resize(1);
  tets.blocks[0].nodes.erase(tets.blocks[0].nodes.begin(), tets.blocks[0].nodes.begin() + 24);
  tets.blocks[0].region.resize(6);
  mesh.blocks.push_back(tets.blocks[0]);
  EXPECT_EQ(joined, 10U);
  EXPECT_EQ(boundary_faces(mesh).size(), 6U + 12U);
}

TEST(BoundaryFaces, FacesBetweenBlocksAreNotBoundary) {
  VolumeMesh mesh = test::cube_of_tets(2);
  ElementBlock& first = mesh.blocks[0];
  ElementBlock second;
  second.nodes.assign(first.nodes.begin() + 4 * 20, first.nodes.end());
  second.region.assign(first.region.begin() + 20, first.region.end());
  const auto whole = boundary_faces(mesh);
  first.nodes.resize(4 * 20);
  first.region.resize(20);
  mesh.blocks.push_back(second);
  EXPECT_EQ(boundary_faces(mesh), whole);
}

TEST(BoundaryFaces, InteriorNodesAreNotIncluded) {
  const auto nodes = nodes_of_faces(boundary_faces(test::cube_of_tets(2)));
  EXPECT_EQ(nodes.size(), 26u);
  EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
  EXPECT_EQ(std::count(nodes.begin(), nodes.end(), 13), 0);  // The center.
}

TEST(BoundaryFaces, EmptyMeshHasNone) {
  EXPECT_TRUE(boundary_faces({}).empty());
  EXPECT_TRUE(nodes_of_faces({}).empty());
}

}  // namespace
}  // namespace lefort::mesh::test_boundary_faces
