#include <lefort/core/units.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/region_sizes.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_element_quality {
namespace {

TEST(RegionSizes, CountsElementsAndVolumesByRegion) {
  for (const ElementShape shape :
       {ElementShape::kTet4, ElementShape::kHex8, ElementShape::kWedge6}) {
    VolumeMesh mesh = make_box(shape, {4, 3, 2}, {8.0, 3.0, 5.0});
    const Index elements = mesh.element_count();
    const auto whole = region_sizes(mesh);
    ASSERT_EQ(whole.size(), 1U);
    EXPECT_EQ(whole.at(0).elements, elements);
    EXPECT_NEAR(whole.at(0).volume_mm3, 120.0, 1e-12);
    ElementBlock& block = mesh.blocks.front();
    for (Index e = 0; e < block.element_count(); ++e) {
      double x_mm = 0.0;
      for (int n = 0; n < node_count(shape); ++n)
        x_mm += mesh.nodes_L[std::size_t(block.element(e)[n])].x() / node_count(shape);
      if (x_mm > 6.0) block.region[std::size_t(e)] = 7;
    }
    const auto parts = region_sizes(mesh);
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts.at(7).elements, elements / 4);
    EXPECT_NEAR(parts.at(7).volume_mm3, 30.0, 1e-12);
    EXPECT_NEAR(parts.at(0).volume_mm3, 90.0, 1e-12);
  }
}

TetQuality quality_of(const VolumeMesh& mesh) {
  const auto& p = mesh.nodes_L;
  return tet_quality(p[0], p[1], p[2], p[3]);
}

TEST(TetQuality, RegularTetrahedronHasTheTheoreticalValues) {
  const TetQuality quality = quality_of(test::regular_tet());
  const double dihedral_deg = degrees_from_radians(std::acos(1.0 / 3.0));
  EXPECT_NEAR(quality.volume_mm3, 1.0 / (6.0 * std::numbers::sqrt2), 1e-15);
  EXPECT_NEAR(quality.min_dihedral_deg, dihedral_deg, 1e-12);
  EXPECT_NEAR(quality.max_dihedral_deg, dihedral_deg, 1e-12);
  EXPECT_NEAR(quality.scaled_jacobian, 1.0, 1e-14);
  EXPECT_NEAR(quality.radius_ratio, 1.0, 1e-14);
}

TEST(TetQuality, CubeCornerHasTheTheoreticalValues) {
  const TetQuality quality = tet_quality({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_NEAR(quality.volume_mm3, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(quality.max_dihedral_deg, 90.0, 1e-12);
  EXPECT_NEAR(quality.min_dihedral_deg, degrees_from_radians(std::acos(1.0 / std::sqrt(3.0))),
              1e-12);
  // The three corners next to the right-angled one have edges 1, sqrt 2, sqrt 2.
  EXPECT_NEAR(quality.scaled_jacobian, std::numbers::sqrt2 / 2.0, 1e-14);
  // r = 1 / (3 + sqrt 3), R = sqrt 3 / 2.
  EXPECT_NEAR(quality.radius_ratio, 3.0 / (3.0 + std::sqrt(3.0)) / (std::sqrt(3.0) / 2.0), 1e-14);
}

TEST(TetQuality, IsInvariantToSizeAndPose) {
  const Vec3 a(0, 0, 0), b(3, 0.2, 0), c(0.4, 2, 0.1), d(0.7, 0.5, 1.9);
  const RigidTransform X =
      Eigen::Translation3d(5, -7, 90) * Eigen::AngleAxisd(1.2, Vec3(1, -1, 2).normalized());
  const TetQuality here = tet_quality(a, b, c, d);
  const TetQuality there = tet_quality(X * (7.0 * a), X * (7.0 * b), X * (7.0 * c), X * (7.0 * d));
  EXPECT_NEAR(there.volume_mm3, 343.0 * here.volume_mm3, 1e-9);
  EXPECT_NEAR(there.min_dihedral_deg, here.min_dihedral_deg, 1e-10);
  EXPECT_NEAR(there.scaled_jacobian, here.scaled_jacobian, 1e-12);
  EXPECT_NEAR(there.radius_ratio, here.radius_ratio, 1e-12);
}

TEST(TetQuality, SliverHasNearlyZeroQualityAndRegularEdges) {
  const TetQuality quality = tet_quality({1, 0, 0}, {0, 1, 1e-3}, {-1, 0, 0}, {0, -1, 1e-3});
  EXPECT_LT(quality.min_dihedral_deg, 0.3);
  EXPECT_GT(quality.max_dihedral_deg, 179.0);
  EXPECT_LT(quality.radius_ratio, 0.01);
}

TEST(TetQuality, InvertedIsNegativeAndFlatIsZero) {
  const TetQuality inverted = tet_quality({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_LT(inverted.volume_mm3, 0.0);
  EXPECT_LT(inverted.scaled_jacobian, 0.0);
  EXPECT_LT(inverted.radius_ratio, 0.0);
  const TetQuality point = tet_quality(Vec3::Ones(), Vec3::Ones(), Vec3::Ones(), Vec3::Ones());
  EXPECT_EQ(point.scaled_jacobian, 0.0);
  EXPECT_EQ(point.radius_ratio, 0.0);
}

/// The ideal element.
std::vector<Vec3> ideal(ElementShape shape) {
  const double h = std::sqrt(0.75);
  switch (shape) {
    case ElementShape::kPyramid5:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, std::sqrt(0.5)}};
    case ElementShape::kWedge6:
      return {{0, 0, 0}, {0.5, h, 0}, {1, 0, 0}, {0, 0, 2}, {0.5, h, 2}, {1, 0, 2}};
    case ElementShape::kHex8:
      return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
              {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    default:
      return test::regular_tet().nodes_L;
  }
}

constexpr std::pair<ElementShape, ElementShape> kLinearAndQuadratic[] = {
    {ElementShape::kTet4, ElementShape::kTet10},
    {ElementShape::kWedge6, ElementShape::kWedge15},
    {ElementShape::kHex8, ElementShape::kHex20}};

TEST(ScaledJacobian, IsOneForTheIdealElementOfAnySizeAndPose) {
  const RigidTransform X =
      Eigen::Translation3d(5, -7, 90) * Eigen::AngleAxisd(1.2, Vec3(1, -1, 2).normalized());
  for (const ElementShape shape :
       {ElementShape::kTet4, ElementShape::kPyramid5, ElementShape::kWedge6, ElementShape::kHex8}) {
    std::vector<Vec3> nodes = ideal(shape);
    for (Vec3& node : nodes) node = X * (3.0 * node);
    EXPECT_NEAR(scaled_jacobian(shape, nodes), 1.0, 1e-13) << name_of(shape);
    for (Vec3& node : nodes) node.x() = -node.x();
    EXPECT_NEAR(scaled_jacobian(shape, nodes), -1.0, 1e-13) << name_of(shape);
  }
}

TEST(ScaledJacobian, AgreesWithTetQuality) {
  const std::vector<Vec3> nodes{{0, 0, 0}, {3, 0.2, 0}, {0.4, 2, 0.1}, {0.7, 0.5, 1.9}};
  EXPECT_NEAR(scaled_jacobian(ElementShape::kTet4, nodes),
              tet_quality(nodes[0], nodes[1], nodes[2], nodes[3]).scaled_jacobian, 1e-14);
}

TEST(ScaledJacobian, QuadraticElementWithStraightEdgesEqualsTheLinearOne) {
  for (const auto& [linear, quadratic] : kLinearAndQuadratic) {
    std::vector<Vec3> nodes = ideal(linear);
    nodes[2] += Vec3(0.1, 0.2, -0.1);
    const double expected = scaled_jacobian(linear, nodes);
    for (const auto& [i, j] : edges_of(linear))
      nodes.emplace_back(0.5 * (nodes[std::size_t(i)] + nodes[std::size_t(j)]));
    EXPECT_NEAR(scaled_jacobian(quadratic, nodes), expected, 1e-14) << name_of(quadratic);
    // An edge whose tangent reverses at its end spans no volume there.
    const auto first_middle = std::size_t(corner_count(quadratic));
    nodes[first_middle] = nodes[0] + 0.2 * (nodes[1] - nodes[0]);
    EXPECT_LT(scaled_jacobian(quadratic, nodes), 0.0) << name_of(quadratic);
  }
}

TEST(ScaledJacobian, IsTheMinimumOverTheCorners) {
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::vector<Vec3> nodes = ideal(ElementShape::kHex8);
    nodes[corner] = 0.5 * nodes[corner] + 0.5 * Vec3(0.5, 0.5, 0.5);
    const double dented = scaled_jacobian(ElementShape::kHex8, nodes);
    EXPECT_LT(dented, 0.9);
    EXPECT_GT(dented, 0.0);
    nodes[corner] = Vec3::Constant(0.5) - (nodes[corner] - Vec3::Constant(0.5));
    EXPECT_LT(scaled_jacobian(ElementShape::kHex8, nodes), 0.0) << corner;
  }
}

TEST(PoorElements, AreReportedWithNumberShapeAndCenter) {
  VolumeMesh mesh = make_mixed_box(BoxMix::kAllLinear, {4, 1, 1}, {4, 1, 1});
  EXPECT_TRUE(poor_elements(mesh, 0.0).empty());
  // Blocks: one hex8, two wedge6, pyramids and tets. The second wedge is inverted.
  std::swap(mesh.blocks[1].nodes[6 + 1], mesh.blocks[1].nodes[6 + 2]);
  std::swap(mesh.blocks[1].nodes[6 + 4], mesh.blocks[1].nodes[6 + 5]);
  const auto poor = poor_elements(mesh, 0.0);
  ASSERT_EQ(poor.size(), 1U);
  EXPECT_EQ(poor[0].number, 2);
  EXPECT_EQ(poor[0].shape, ElementShape::kWedge6);
  EXPECT_LT((poor[0].center_L - Vec3(1.0 + 1.0 / 3, 2.0 / 3, 0.5)).norm(), 1e-14);
  EXPECT_LT(poor[0].scaled_jacobian, 0.0);
  EXPECT_EQ(Index(poor_elements(mesh, 2.0).size()), mesh.element_count());
}

TEST(MeshQuality, SummarizesAMesh) {
  VolumeMesh mesh = test::cube_of_tets(2);
  const MeshQuality quality = measure_quality(mesh);
  EXPECT_EQ(quality.elements, 48);
  EXPECT_NEAR(quality.volume_mm3, 8.0, 1e-14);
  EXPECT_NEAR(quality.min_volume_mm3, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(quality.min_dihedral_deg, 45.0, 1e-12);
  EXPECT_NEAR(quality.max_dihedral_deg, 90.0, 1e-12);
  EXPECT_NEAR(quality.mean_scaled_jacobian, quality.min_scaled_jacobian, 1e-14);
  EXPECT_NEAR(quality.mean_radius_ratio, quality.min_radius_ratio, 1e-14);
  EXPECT_TRUE(quality.inverted.empty());
  const auto& bins = quality.dihedral_histogram;
  EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), Index(0)), 48);
  EXPECT_EQ(bins[4], 48);
}

TEST(MeshQuality, CountsInvertedElementsThroughAllBlocks) {
  VolumeMesh mesh = test::cube_of_tets(1);
  mesh.blocks.push_back(mesh.blocks[0]);
  std::swap(mesh.blocks[1].nodes[4 * 2], mesh.blocks[1].nodes[4 * 2 + 1]);
  EXPECT_EQ(measure_quality(mesh).inverted, (std::vector<Index>{8}));
}

TEST(DihedralRange, RegularShapesHaveTheTheoreticalAngles) {
  const auto range = [](ElementShape shape) { return dihedral_range_deg(shape, ideal(shape)); };
  const double tet_deg = degrees_from_radians(std::acos(1.0 / 3.0));
  EXPECT_NEAR(range(ElementShape::kTet4)[0], tet_deg, 1e-10);
  EXPECT_NEAR(range(ElementShape::kTet4)[1], tet_deg, 1e-10);
  EXPECT_NEAR(range(ElementShape::kWedge6)[0], 60.0, 1e-10);
  EXPECT_NEAR(range(ElementShape::kWedge6)[1], 90.0, 1e-10);
  EXPECT_NEAR(range(ElementShape::kHex8)[0], 90.0, 1e-10);
  EXPECT_NEAR(range(ElementShape::kHex8)[1], 90.0, 1e-10);
  // Half an octahedron, whose faces meet at 109.47 degrees; at the base at half of that.
  EXPECT_NEAR(range(ElementShape::kPyramid5)[0], (180.0 - tet_deg) / 2.0, 1e-10);
  EXPECT_NEAR(range(ElementShape::kPyramid5)[1], 180.0 - tet_deg, 1e-10);
}

TEST(ElementVolume, IsExactForABilinearFace) {
  // The cube whose upper face is z = 1 + x y / 2, a bilinear patch: 1 + 1/8.
  std::vector<Vec3> hex = ideal(ElementShape::kHex8);
  ASSERT_EQ(hex[6], Vec3(1, 1, 1));
  hex[6].z() = 1.5;
  EXPECT_NEAR(volume_of(ElementShape::kHex8, hex), 1.125, 1e-14);
  std::swap(hex[0], hex[4]);
  std::swap(hex[1], hex[5]);
  std::swap(hex[2], hex[6]);
  std::swap(hex[3], hex[7]);
  EXPECT_NEAR(volume_of(ElementShape::kHex8, hex), -1.125, 1e-14);
}

TEST(MeshQuality, SummarizesEachShapeOfAMixedMesh) {
  const VolumeMesh mesh = make_mixed_box(BoxMix::kAllLinear, {4, 1, 1}, {4, 1, 1});
  const MeshQuality quality = measure_quality(mesh);
  EXPECT_EQ(quality.elements, mesh.element_count());
  EXPECT_NEAR(quality.volume_mm3, 4.0, 1e-13);
  EXPECT_TRUE(quality.inverted.empty());
  ASSERT_EQ(quality.by_shape.size(), 4U);
  Index elements = 0;
  double volume_mm3 = 0.0;
  for (const auto& [shape, summary] : quality.by_shape) {
    elements += summary.elements;
    volume_mm3 += summary.volume_mm3;
    EXPECT_GE(summary.min_scaled_jacobian, quality.min_scaled_jacobian);
    const auto& bins = summary.jacobian_histogram;
    EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), Index(0)), summary.elements);
  }
  EXPECT_EQ(elements, quality.elements);
  EXPECT_NEAR(volume_mm3, 4.0, 1e-13);
}

TEST(MeshQuality, EmptyMeshHasNoElements) { EXPECT_EQ(measure_quality({}).elements, 0); }

}  // namespace
}  // namespace lefort::mesh::test_element_quality
