#include <lefort/verify/mapped_mesh.h>
#include <lefort/verify/shapes.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace lefort::verify::test_mapped_mesh {
namespace {

TEST(GradedCube, GradesCornersByThePowerAndPutsMidSideNodesInTheMiddle) {
  const mesh::VolumeMesh cube = graded_cube(mesh::ElementShape::kHex20, 2, 3.0, 2.0);
  // Corners at 1 - (1 - i / 2)^2 of 3 mm: 0, 2.25 and 3.
  const auto has = [&](const Vec3& wanted) {
    return std::ranges::any_of(cube.nodes_L,
                               [&](const Vec3& p) { return (p - wanted).norm() < 1e-12; });
  };
  for (const double x : {0.0, 2.25, 3.0}) EXPECT_TRUE(has({x, 3.0, 2.25})) << x;
  for (const double x : {1.125, 2.625}) EXPECT_TRUE(has({x, 2.25, 0.0})) << x;
  EXPECT_EQ(graded_corner(1, 4, 2.0), 1.0 - 0.75 * 0.75);
  for (const std::int32_t node : cube.node_sets.at("z1"))
    EXPECT_EQ(cube.nodes_L[std::size_t(node)].z(), 3.0);
}

/// So that displacements of consecutive meshes can be compared.
TEST(GradedCube, ContainsTheCornersOfACubeWithHalfTheCells) {
  for (const mesh::ElementShape shape : kAllShapes) {
    const mesh::VolumeMesh fine = graded_cube(shape, 4, 1.0, 2.5);
    for (const Vec3& corner : graded_cube(mesh::ElementShape::kHex8, 2, 1.0, 2.5).nodes_L)
      EXPECT_TRUE(std::ranges::any_of(fine.nodes_L,
                                      [&](const Vec3& p) { return (p - corner).norm() < 1e-12; }))
          << text_of(shape) << ' ' << corner.transpose();
  }
}

}  // namespace
}  // namespace lefort::verify::test_mapped_mesh
