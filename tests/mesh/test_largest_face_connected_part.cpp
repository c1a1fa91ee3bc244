#include <lefort/mesh/largest_face_connected_part.h>

#include <gtest/gtest.h>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_largest_face_connected_part {
namespace {

/// A cube of 6 n^3 tetrahedra, then those of one more cube with its low corner at `corner`, on
/// common nodes where the two meet.
VolumeMesh two_cubes(int n, const Vec3& corner) {
  VolumeMesh mesh = test::cube_of_tets(n);
  const VolumeMesh small = test::cube_of_tets(1);
  std::vector<std::int32_t> number;
  for (const Vec3& p : small.nodes_L) {
    const Vec3 moved = p + corner;
    std::size_t same = 0;
    while (same < mesh.nodes_L.size() && mesh.nodes_L[same] != moved) ++same;
    if (same == mesh.nodes_L.size()) mesh.nodes_L.push_back(moved);
    number.push_back(std::int32_t(same));
  }
  for (const std::int32_t node : small.blocks[0].nodes)
    mesh.blocks[0].nodes.push_back(number[std::size_t(node)]);
  mesh.blocks[0].region.resize(mesh.blocks[0].nodes.size() / 4, 7);
  return mesh;
}

TEST(LargestFaceConnectedPart, DoesNotChangeAConnectedMesh) {
  const VolumeMesh mesh = two_cubes(2, {2, 0, 0});  // Face to face.
  const VolumeMesh part = largest_face_connected_part(mesh);
  EXPECT_EQ(part.nodes_L, mesh.nodes_L);
  EXPECT_EQ(part.blocks[0].nodes, mesh.blocks[0].nodes);
  EXPECT_EQ(part.blocks[0].region, mesh.blocks[0].region);
}

TEST(LargestFaceConnectedPart, RemovesDisconnectedPartsAndTheirNodes) {
  const VolumeMesh part = largest_face_connected_part(two_cubes(2, {5, 0, 0}));
  EXPECT_EQ(part.element_count(), 48);
  EXPECT_EQ(part.node_count(), 27);
}

TEST(LargestFaceConnectedPart, RemovesPartsConnectedByAnEdgeOrANode) {
  EXPECT_EQ(largest_face_connected_part(two_cubes(2, {2, 2, 0})).element_count(), 48);
  EXPECT_EQ(largest_face_connected_part(two_cubes(2, {2, 2, 2})).element_count(), 48);
}

TEST(LargestFaceConnectedPart, RemovesAHingeWithinOnePart) {
  // Two by two cubes with two more on top, on a diagonal: these two have an edge in common, and are
  // connected through the cubes below.
  VolumeMesh mesh = test::cube_of_tets(2);
  ElementBlock& block = mesh.blocks[0];
  ElementBlock kept;
  for (Index e = 0; e < block.element_count(); ++e) {
    const Index cube = e / 6;
    if (cube == 5 || cube == 6) continue;  // Of 0 to 7, i fastest: on top, at (1, 0) and (0, 1).
    kept.nodes.insert(kept.nodes.end(), block.element(e), block.element(e) + 4);
    kept.region.push_back(0);
  }
  block = kept;
  const VolumeMesh part = largest_face_connected_part(mesh);
  EXPECT_LT(part.element_count(), 36);
  EXPECT_GE(part.element_count(), 30);
}

TEST(LargestFaceConnectedPart, EmptyMeshStaysEmpty) {
  EXPECT_EQ(largest_face_connected_part(test::tets({}, {})).element_count(), 0);
}

}  // namespace
}  // namespace lefort::mesh::test_largest_face_connected_part
