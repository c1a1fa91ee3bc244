#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_layer.h>
#include <lefort/mesh/layer_thickness.h>

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_layer_thickness {
namespace {

std::vector<Face> top_of(const VolumeMesh& mesh) {
  std::vector<Face> faces;
  for (const Face& face : boundary_faces(mesh)) {
    const auto nodes = nodes_of(face);
    if (std::all_of(nodes.begin(), nodes.end(),
                    [&](std::int32_t node) { return mesh.nodes_L[std::size_t(node)].z() == 6.0; }))
      faces.push_back(face);
  }
  return faces;
}

TEST(LayerThickness, PlateHasItsThickness) {
  const VolumeMesh cube = test::cube_of_tets(6);
  const std::vector<HalfSpace> sides{{Vec3::Zero(), Vec3::UnitX()},
                                     {Vec3::Zero(), Vec3::UnitY()},
                                     {Vec3::Constant(6.0), -Vec3::UnitX()},
                                     {Vec3::Constant(6.0), -Vec3::UnitY()}};
  const VolumeMesh mesh =
      add_boundary_layer(cube, top_of(cube), sides, {.thickness_mm = 1.2, .layers = 3}).value();
  const LayerThickness layer = layer_thickness_statistics(mesh, 1, top_of(mesh), 3, 1.2);
  EXPECT_NEAR(layer.area_mm2, 36.0, 1e-12);
  EXPECT_NEAR(layer.covered_fraction, 1.0, 1e-12);
  EXPECT_NEAR(layer.mean_mm, 1.2, 1e-12);
  EXPECT_NEAR(layer.p05_mm, 1.2, 1e-12);
  EXPECT_NEAR(layer.full_thickness_fraction, 1.0, 1e-12);
  EXPECT_TRUE(layer.thin.empty());

  const LayerThickness wanted_more = layer_thickness_statistics(mesh, 1, top_of(mesh), 3, 2.5);
  EXPECT_EQ(wanted_more.full_thickness_fraction, 0.0);
  ASSERT_EQ(wanted_more.thin.size(), 1U);  // All of it.
  EXPECT_NEAR(wanted_more.thin[0].area_mm2, 36.0, 1e-12);
  EXPECT_LT((wanted_more.thin[0].center_L - Vec3(3.0, 3.0, 6.0)).norm(), 1e-12);
}

TEST(LayerThickness, ReportsTheUncoveredBorder) {
  const VolumeMesh cube = test::cube_of_tets(6);
  const VolumeMesh mesh = add_boundary_layer(cube, top_of(cube), {}, {.thickness_mm = 0.5}).value();
  const LayerThickness layer = layer_thickness_statistics(mesh, 1, top_of(mesh), 2, 0.5);
  EXPECT_NEAR(layer.covered_fraction, 16.0 / 36.0, 1e-12);  // Without the outer ring of squares.
  EXPECT_NEAR(layer.mean_mm, 0.5, 1e-12);
  ASSERT_EQ(layer.thin.size(), 1U);
  EXPECT_NEAR(layer.thin[0].area_mm2, 20.0, 1e-12);
  EXPECT_LT((layer.thin[0].center_L - Vec3(3.0, 3.0, 6.0)).norm(), 1e-12);
  EXPECT_EQ(layer_thickness_statistics(mesh, 5, top_of(mesh), 2, 0.5).covered_fraction,
            0.0);  // Another region.
}

}  // namespace
}  // namespace lefort::mesh::test_layer_thickness
