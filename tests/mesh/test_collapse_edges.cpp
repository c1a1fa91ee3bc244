#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/collapse_edges.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/largest_face_connected_part.h>

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_collapse_edges {
namespace {

constexpr double kPoor = 0.12;

/// A cube of side 4 with one of its nodes moved next to another.
VolumeMesh cube_with(const Vec3& from, const Vec3& to) {
  VolumeMesh mesh = test::cube_of_tets(4);
  *std::find(mesh.nodes_L.begin(), mesh.nodes_L.end(), from) = to;
  return mesh;
}

TEST(CollapseEdges, RemovesNeedlesFromTheInterior) {
  VolumeMesh mesh = cube_with({2, 2, 2}, {2.93, 2, 2});
  ASSERT_FALSE(poor_elements(mesh, kPoor).empty());
  const std::vector<Face3> surface = triangles_of(boundary_faces(mesh));
  EXPECT_EQ(collapse_edges(mesh, kPoor), 1);
  EXPECT_EQ(mesh.node_count(), 124);
  EXPECT_TRUE(poor_elements(mesh, kPoor).empty());
  EXPECT_NEAR(measure_quality(mesh).volume_mm3, 64.0, 1e-12);
  EXPECT_EQ(triangles_of(boundary_faces(mesh)).size(), surface.size());
  EXPECT_EQ(largest_face_connected_part(mesh).element_count(), mesh.element_count());
}

TEST(CollapseEdges, RemovesNeedlesFromAFlatBoundary) {
  VolumeMesh mesh = cube_with({2, 2, 4}, {2.93, 2, 4});
  ASSERT_FALSE(poor_elements(mesh, kPoor).empty());
  const std::size_t before = boundary_faces(mesh).size();
  EXPECT_EQ(collapse_edges(mesh, kPoor), 1);
  EXPECT_NEAR(measure_quality(mesh).volume_mm3, 64.0, 1e-12);
  EXPECT_TRUE(poor_elements(mesh, kPoor).empty());
  EXPECT_EQ(boundary_faces(mesh).size(), before - 2);
  EXPECT_EQ(largest_face_connected_part(mesh).element_count(), mesh.element_count());
}

TEST(CollapseEdges, KeepsCornersAndRidges) {
  // The short edge connects a corner with a ridge, and a ridge with a side: the second end vanishes.
  for (const auto& [from, to] :
       {std::pair(Vec3(1, 0, 4), Vec3(0.07, 0, 4)), std::pair(Vec3(2, 1, 4), Vec3(2, 0.07, 4))}) {
    VolumeMesh mesh = cube_with(from, to);
    ASSERT_FALSE(poor_elements(mesh, kPoor).empty());
    collapse_edges(mesh, kPoor);
    EXPECT_NEAR(measure_quality(mesh).volume_mm3, 64.0, 1e-12);
    for (const double x : {0.0, 4.0})
      for (const double y : {0.0, 4.0})
        EXPECT_EQ(std::count(mesh.nodes_L.begin(), mesh.nodes_L.end(), Vec3(x, y, 4.0)), 1);
  }
}

TEST(CollapseEdges, DoesNotChangeAGoodMesh) {
  VolumeMesh mesh = test::cube_of_tets(3);
  const VolumeMesh before = mesh;
  EXPECT_EQ(collapse_edges(mesh, kPoor), 0);
  EXPECT_EQ(mesh.nodes_L, before.nodes_L);
  EXPECT_EQ(mesh.blocks[0].nodes, before.blocks[0].nodes);
}

TEST(CollapseEdges, DoesNotCloseATunnel) {
  // A ring of cubes, one cube thick: every edge around the hole belongs to its link.
  VolumeMesh all = test::cube_of_tets(3), ring;
  ring.nodes_L = all.nodes_L;
  ElementBlock& block = ring.blocks.emplace_back();
  for (Index e = 0; e < all.element_count(); ++e) {
    const std::int32_t* tet = all.blocks[0].element(e);
    Vec3 center = Vec3::Zero();
    for (int n = 0; n < 4; ++n) center += all.nodes_L[std::size_t(tet[n])] / 4.0;
    const bool is_core = center.x() > 1 && center.x() < 2 && center.y() > 1 && center.y() < 2;
    if (is_core || center.z() > 1) continue;
    block.nodes.insert(block.nodes.end(), tet, tet + 4);
    block.region.push_back(0);
  }
  ring = largest_face_connected_part(ring);
  const auto euler = [](const VolumeMesh& mesh) {  // Of the boundary: 0 for a torus.
    const auto faces = boundary_faces(mesh);
    return Index(nodes_of_faces(faces).size()) - Index(faces.size()) / 2;
  };
  ASSERT_EQ(euler(ring), 0);
  collapse_edges(ring, 1.0);  // Everything is poor.
  EXPECT_EQ(euler(ring), 0);
  EXPECT_GT(measure_quality(ring).min_scaled_jacobian, 0.0);
}

}  // namespace
}  // namespace lefort::mesh::test_collapse_edges
