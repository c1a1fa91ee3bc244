#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/snap_boundary_to_level.h>

#include <gtest/gtest.h>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_snap_boundary_to_level {
namespace {

TEST(SnapBoundaryToLevel, SnapsACubeToALargerCube) {
  VolumeMesh mesh = test::cube_of_tets(4);
  const auto inside = [](const Vec3& p) { return p.z() < 4.2 && p.z() > -10.0; };
  EXPECT_EQ(snap_boundary_to_level(mesh, inside, 1.0, 1e-6), 0);
  for (const Vec3& p : mesh.nodes_L)
    if (p.z() > 3.5 && p.x() > 0.5 && p.x() < 3.5 && p.y() > 0.5 && p.y() < 3.5) {
      EXPECT_NEAR(p.z(), 4.2, 1e-6);
    }
  EXPECT_TRUE(measure_quality(mesh).inverted.empty());
}

TEST(SnapBoundaryToLevel, DoesNotMoveNodesOnTheSurface) {
  VolumeMesh mesh = test::regular_tet();
  const auto before = mesh.nodes_L;
  const Vec3 middle = (before[0] + before[1] + before[2] + before[3]) / 4.0;
  const double radius = (before[0] - middle).norm();
  const auto inside = [&](const Vec3& p) { return (p - middle).norm() < radius; };
  EXPECT_EQ(snap_boundary_to_level(mesh, inside, 1.0, 1e-6), 0);
  EXPECT_EQ(mesh.nodes_L, before);
}

TEST(SnapBoundaryToLevel, DoesNotMoveNodesBeyondReach) {
  VolumeMesh mesh = test::regular_tet();
  const auto before = mesh.nodes_L;
  EXPECT_EQ(snap_boundary_to_level(
                mesh, [](const Vec3&) { return true; }, 1.0, 1e-6),
            0);
  EXPECT_EQ(mesh.nodes_L, before);
}

TEST(SnapBoundaryToLevel, StopsBeforeAnElementIsFlattened) {
  VolumeMesh mesh = test::regular_tet();
  // The tip should move down to the base.
  const auto inside = [](const Vec3& p) { return p.z() < 0.01 && p.z() > -5.0; };
  EXPECT_GE(snap_boundary_to_level(mesh, inside, 1.0, 1e-6), 1);
  EXPECT_TRUE(measure_quality(mesh).inverted.empty());
}

}  // namespace
}  // namespace lefort::mesh::test_snap_boundary_to_level
