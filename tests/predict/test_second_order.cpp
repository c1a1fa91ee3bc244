#include <lefort/mesh/elevate_order.h>
#include <lefort/mesh/open_slit.h>
#include <lefort/predict/boundary_areas.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/second_order_tissue.h>

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "support/box_mesh.h"
#include "support/paper_boundary.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_second_order {
namespace {

constexpr double kSize_mm = 12.0;

mesh::VolumeMesh irregular_block() {
  return mesh::elevate_order(
             test::box_mesh(
                 {.cells = {3, 3, 3}, .size_mm = Vec3::Constant(kSize_mm), .distortion = 0.15}))
      .mesh;
}

/// The block of tissue_block.h as tet10.
FaceModel quadratic_block() {
  FaceModel model = test::block_on_slab();
  model.tissue = mesh::elevate_order(std::move(model.tissue)).mesh;
  auto& sets_of_nodes = model.tissue.node_sets;
  sets_of_nodes[sets::kMobilizedSegment] = sets_of_nodes.at("z0");
  sets_of_nodes[sets::kFixed] = sets_of_nodes.at("z1");
  return model;
}

TEST(SecondOrder, UniformPressureOfContactLeavesAUniformState) {  // Contact patch test, tri6.
  const FaceModel model = quadratic_block();
  PredictionOptions options = test::paper_options();
  options.tissue.poisson = 0.0;
  options.tissue.element_order = 2;
  options.solver.relative_tolerance = 1e-10;
  const auto prediction =
      predict_face(model, {test::straight({0.0, 0.0, 2.0}, 2)}, options).value();
  ASSERT_TRUE(prediction.converged());
  const std::vector<Vec3>& u = prediction.steps.back().displacement_mm;
  const double lowest_mm = u[std::size_t(model.tissue.node_sets.at("z0").front())].z();
  EXPECT_GT(lowest_mm, 1.5);
  for (std::size_t n = 0; n < u.size(); ++n) {
    const double height = model.tissue.nodes_L[n].z() / test::kHeight_mm;
    EXPECT_NEAR((u[n] - Vec3(0, 0, lowest_mm * (1.0 - height))).norm(), 0.0, 1e-5) << n;
  }
}

TEST(SecondOrder, LoadAreasAreTheIntegralsOfShapeFunctions) {
  const mesh::VolumeMesh block = irregular_block();
  double area_mm2 = 0.0, load_mm2 = 0.0;
  const auto nodes = boundary_nodes(block);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    area_mm2 += nodes[n].area_mm2;
    load_mm2 += nodes[n].load_area_mm2;
    if (n < 4 * 4 * 4) {  // Corners.
      EXPECT_EQ(nodes[n].load_area_mm2, 0.0);
    }
  }
  EXPECT_NEAR(area_mm2, 6.0 * kSize_mm * kSize_mm, 1e-9);
  EXPECT_NEAR(load_mm2, 6.0 * kSize_mm * kSize_mm, 1e-9);
}

TEST(SecondOrder, TheSkinFollowsAQuadraticDisplacementExactly) {
  const mesh::VolumeMesh block = irregular_block();
  const auto displacement = [](const Vec3& p) {
    return Vec3(0.01 * p.y() * p.z(), 0.02 * p.x() * p.x() - p.z(), 0.03 * p.x() * p.y() + 1.0);
  };
  std::vector<Vec3> u;
  for (const Vec3& p : block.nodes_L) u.push_back(displacement(p));
  geometry::TriangleMesh skin;  // Points on the sides of the block that are not nodes.
  skin.vertices = {{0.0, 3.3, 4.7}, {kSize_mm, 0.9, 9.1}, {2.2, kSize_mm, 5.6}};
  skin.triangles = {{0, 1, 2}};
  const auto skin_mm = skin_displacement(embed_skin(skin, block, 2.0), u);
  for (std::size_t v = 0; v < 3; ++v)
    EXPECT_NEAR((skin_mm[v] - displacement(skin.vertices[v])).norm(), 0.0, 1e-12);
}

/// A cube of tissue, open to all sides.
TissueDomain cube() {
  TissueDomain domain;
  domain.soft_tissue_level.grid.size = {17, 17, 17};
  domain.soft_tissue_level.values.assign(17 * 17 * 17, 1.0F);
  domain.box_L = Box3(Vec3::Zero(), Vec3::Constant(kSize_mm));
  for (int axis = 0; axis < 3; ++axis) {
    domain.cuts_L.push_back({domain.box_L.min(), Vec3::Unit(axis)});
    domain.cuts_L.push_back({domain.box_L.max(), -Vec3::Unit(axis)});
  }
  return domain;
}

TEST(SecondOrder, LipsArePairedAtMidEdgeNodes) {
  const mesh::VolumeMesh block =
      test::box_mesh({.cells = {4, 4, 4}, .size_mm = Vec3::Constant(kSize_mm)});
  TissueWithLips linear{block, {}};
  const auto level = [](const Vec3& p) { return p.z() - 6.0; };
  mesh::SlitMesh slit = mesh::open_slit(mesh::VolumeMesh{block.nodes_L, block.blocks, {}, {}, {}},
                                        {level, [](const Vec3& p) { return 9.5 - p.y(); }},
                                        [](const Vec3&) { return true; });
  ASSERT_FALSE(slit.pairs.empty());
  for (const auto& [first, second, area_mm2] : slit.pairs)
    linear.lips.pairs.push_back({first, second, area_mm2, Vec3::UnitZ()});
  linear.tissue = slit.mesh;
  linear.tissue.face_sets = {{sets::kUpperLip, slit.first_faces},
                             {sets::kLowerLip, slit.second_faces}};
  const TissueWithLips quadratic = second_order_tissue(std::move(linear), cube()).value();
  double area_mm2 = 0.0;
  for (const LipPair& pair : quadratic.lips.pairs) {
    EXPECT_NE(pair.upper, pair.lower);
    EXPECT_EQ(quadratic.tissue.nodes_L[std::size_t(pair.upper)],
              quadratic.tissue.nodes_L[std::size_t(pair.lower)]);
    area_mm2 += pair.area_mm2;
  }
  EXPECT_LE(area_mm2, slit.area_mm2 * (1.0 + 1e-12));
  EXPECT_GT(area_mm2, 0.8 * slit.area_mm2);  // The edges of the border are not paired.
}

TEST(SecondOrder, AWedgeThatCannotBeSplitIsAnError) {
  mesh::VolumeMesh wedge;
  wedge.nodes_L = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  wedge.blocks = {
      {.shape = mesh::ElementShape::kWedge6, .nodes = {0, 2, 1, 3, 5, 4}, .region = {0}}};
  EXPECT_TRUE(second_order_tissue({wedge, {}}, cube()));
  wedge.nodes_L[5] = {-0.2, -0.6, 1.0};  // The upper triangle is inverted.
  const auto split = second_order_tissue({wedge, {}}, cube());
  ASSERT_FALSE(split);
  EXPECT_EQ(split.error().code, ErrorCode::kMeshingFailed);
  EXPECT_NE(split.error().message.find("flat or inverted"), std::string::npos);
}

}  // namespace
}  // namespace lefort::predict::test_second_order
