#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/improve_tets.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_improve_tets {
namespace {

bool is_in_cube(const Vec3& p) { return p.minCoeff() > 0.0 && p.maxCoeff() < 4.0; }

/// Whether the node lies inside the cube of side 4, not on its boundary.
bool is_inner(const Vec3& p) { return p.minCoeff() > 0.5 && p.maxCoeff() < 3.5; }
bool is_on_top(const Vec3& p) {
  return p.z() == 4.0 && p.head<2>().minCoeff() > 0.5 && p.head<2>().maxCoeff() < 3.5;
}

/// A cube of side 4 whose interior and upper nodes are displaced until there are slivers.
VolumeMesh shaken_cube() {
  VolumeMesh mesh = test::cube_of_tets(4);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-0.38, 0.38);
  for (Vec3& p : mesh.nodes_L) {
    const double x = shift(random), y = shift(random), z = shift(random);
    if (is_inner(p)) p += Vec3(x, y, z);
    if (is_on_top(p)) p += Vec3(x, y, 0.0);
  }
  return mesh;
}

TEST(ImproveTets, IncreasesTheSmallestAngleAndKeepsTheVolume) {
  VolumeMesh mesh = shaken_cube();
  const MeshQuality before = measure_quality(mesh);
  ASSERT_TRUE(before.inverted.empty());
  ASSERT_LT(before.min_dihedral_deg, 12.0);
  EXPECT_EQ(improve_tets(mesh, is_in_cube, {.angle_deg = 18.0}), 0);
  const MeshQuality after = measure_quality(mesh);
  EXPECT_GE(after.min_dihedral_deg, 18.0);
  EXPECT_LE(after.max_dihedral_deg, 162.0);
  EXPECT_NEAR(after.volume_mm3, 64.0, 0.05);
}

TEST(ImproveTets, KeepsTheBoundaryOnTheLevel) {
  VolumeMesh mesh = shaken_cube();
  improve_tets(mesh, is_in_cube, {.angle_deg = 18.0, .tolerance_mm = 1e-5});
  for (const std::int32_t node : nodes_of_faces(boundary_faces(mesh))) {
    const Vec3& p = mesh.nodes_L[std::size_t(node)];
    EXPECT_NEAR(std::min(p.minCoeff(), 4.0 - p.maxCoeff()), 0.0, 1e-5);
  }
}

TEST(ImproveTets, DoesNotMoveNodesOfGoodElements) {
  VolumeMesh mesh = test::cube_of_tets(4);
  const auto before = mesh.nodes_L;
  EXPECT_EQ(improve_tets(mesh, is_in_cube), 0);
  EXPECT_EQ(mesh.nodes_L, before);
}

TEST(ImproveTets, ReturnsTheNumberOfElementsStillBelowTheTarget) {
  const double h = 1e-3;  // Flat; its faces would have to rotate more than allowed.
  VolumeMesh mesh = test::tets({{1, 0, 0}, {0, 1, h}, {-1, 0, 0}, {0, -1, h}}, {0, 1, 2, 3});
  if (measure_quality(mesh).volume_mm3 < 0.0)
    std::swap(mesh.blocks[0].nodes[0], mesh.blocks[0].nodes[1]);
  EXPECT_EQ(improve_tets(mesh, [](const Vec3& p) { return std::abs(p.z()) < 0.01; }), 1);
  EXPECT_GT(measure_quality(mesh).volume_mm3, 0.0);
}

TEST(ImproveTets, SameInputSameBits) {
  VolumeMesh once = shaken_cube(), again = shaken_cube();
  improve_tets(once, is_in_cube);
  improve_tets(again, is_in_cube);
  EXPECT_EQ(once.nodes_L, again.nodes_L);
}

}  // namespace
}  // namespace lefort::mesh::test_improve_tets
