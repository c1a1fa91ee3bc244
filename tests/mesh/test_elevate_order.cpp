#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/fit_mid_edge_nodes.h>
#include <lefort/mesh/split_into_tets.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace lefort::mesh::test_elevate_order {
namespace {

double volume_of_surface(const VolumeMesh& mesh) {
  return geometry::signed_volume_mm3({mesh.nodes_L, triangles_of(boundary_faces(mesh))});
}

TEST(ElevateOrder, PutsANodeInTheMiddleOfEachEdge) {
  const QuadraticMesh quadratic =
      elevate_order(make_box(ElementShape::kWedge6, {3, 2, 2}, {3, 2, 2}));
  const VolumeMesh wanted = make_box(ElementShape::kWedge15, {3, 2, 2}, {3, 2, 2});
  EXPECT_EQ(quadratic.corner_count(), 4 * 3 * 3);
  EXPECT_EQ(quadratic.mesh.nodes_L, wanted.nodes_L);
  EXPECT_EQ(quadratic.mesh.blocks.front().nodes, wanted.blocks.front().nodes);
  EXPECT_EQ(quadratic.mesh.face_sets, wanted.face_sets);
  EXPECT_EQ(quadratic.mesh.node_sets, wanted.node_sets);
  for (std::size_t m = 0; m < quadratic.ends.size(); ++m) {
    const auto [a, b] = quadratic.ends[m];
    const auto& nodes_L = quadratic.mesh.nodes_L;
    const Vec3 middle = 0.5 * (nodes_L[std::size_t(a)] + nodes_L[std::size_t(b)]);
    EXPECT_EQ(nodes_L[std::size_t(quadratic.corner_count()) + m], middle);
  }
}

TEST(ElevateOrder, ANodeSetWithoutFacesGetsTheEdgesBetweenItsNodes) {
  VolumeMesh mesh = make_box(ElementShape::kTet4, {1, 1, 1}, Vec3::Ones());
  mesh.node_sets = {{"edge", {0, 1}}, {"point", {0}}};
  mesh.face_sets.clear();
  const QuadraticMesh quadratic = elevate_order(mesh);
  ASSERT_EQ(quadratic.mesh.node_sets.at("edge").size(), 3U);
  EXPECT_EQ(quadratic.mesh.nodes_L[std::size_t(quadratic.mesh.node_sets.at("edge")[2])],
            Vec3(0.5 * (mesh.nodes_L[0] + mesh.nodes_L[1])));
  EXPECT_EQ(quadratic.mesh.node_sets.at("point").size(), 1U);
}

TEST(SplitIntoTets, ElementsOfAllShapesFitTogether) {
  std::mt19937 random(5);
  const VolumeMesh mixed = with_inner_nodes_moved(
      make_mixed_box(BoxMix::kAllLinear, {8, 3, 2}, {8, 3, 2}), Vec3::Constant(0.1), random);
  const VolumeMesh tets = split_into_tets(mixed);
  ASSERT_EQ(tets.blocks.size(), 1U);
  const MeshQuality quality = measure_quality(tets);
  EXPECT_TRUE(quality.inverted.empty());
  EXPECT_NEAR(quality.volume_mm3, 48.0, 1e-10);
  const auto boundary = triangles_of(boundary_faces(tets));
  EXPECT_TRUE(geometry::is_closed({tets.nodes_L, boundary}));
  EXPECT_NEAR(volume_of_surface(tets), 48.0, 1e-10);  // No boundary face is inside.
  EXPECT_EQ(boundary.size(), triangles_of(boundary_faces(mixed)).size());
  EXPECT_EQ(tets.face_sets.at("boundary").size(), boundary.size());
  EXPECT_NO_THROW(static_cast<void>(elevate_order(tets)));  // The faces of sets are of elements.
}

constexpr double kRadius_mm = 10.0;

constexpr double kSide_mm = 8.0;

/// Under a sphere around the origin: |x|, |y| <= 4 mm, 0 <= z.
VolumeMesh dome(int cells) {
  VolumeMesh mesh = make_box(ElementShape::kTet4, {cells, cells, cells}, {kSide_mm, kSide_mm, 1.0});
  for (Vec3& p : mesh.nodes_L) {
    p -= Vec3(0.5 * kSide_mm, 0.5 * kSide_mm, 0.0);
    p.z() *= std::sqrt(kRadius_mm * kRadius_mm - p.x() * p.x() - p.y() * p.y());
  }
  return mesh;
}

CurvedSurface sphere() {
  return {[](const Vec3& p) { return p.norm() < kRadius_mm; },
          [](const Vec3& p) {
            std::vector<Vec3> normals;
            for (int axis = 0; axis < 2; ++axis)
              for (const double side : {-1.0, 1.0})
                if (std::abs(p[axis] - side * 0.5 * kSide_mm) < 1e-6)
                  normals.emplace_back(-side * Vec3::Unit(axis));
            if (std::abs(p.z()) < 1e-6) normals.emplace_back(Vec3::UnitZ());
            return normals;
          }};
}

/// Volume under the sphere, by the midpoint rule.
double dome_volume_mm3() {
  constexpr int kCells = 1000;
  double sum = 0.0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const double x = kSide_mm * ((i + 0.5) / kCells - 0.5);
      const double y = kSide_mm * ((j + 0.5) / kCells - 0.5);
      sum += std::sqrt(kRadius_mm * kRadius_mm - x * x - y * y);
    }
  return sum * kSide_mm * kSide_mm / (kCells * kCells);
}

TEST(FitMidEdgeNodes, CurvedEdgesReduceTheErrorOfTheVolume) {
  const QuadraticMesh quadratic = elevate_order(dome(3));
  const CurvedMesh curved = fit_mid_edge_nodes(quadratic, sphere());
  const double error = dome_volume_mm3() - volume_of_surface(quadratic.mesh);
  // The triangles of a face have half its edges: a quarter of the error.
  const double after = dome_volume_mm3() - volume_of_surface(curved.quadratic.mesh);
  EXPECT_NEAR(after / error, 0.25, 0.03);
  EXPECT_EQ(curved.curved, 3 * 9 + 2 * 3);  // All edges of the upper side.
  EXPECT_EQ(curved.limited, 0);
  EXPECT_GE(curved.min_ratio, kMinJacobianRatio);
  const auto& before_L = quadratic.mesh.nodes_L;
  for (std::size_t n = 0; n < before_L.size(); ++n) {
    const Vec3& after_L = curved.quadratic.mesh.nodes_L[n];
    for (const Vec3& normal : sphere().planes_at_L(before_L[n])) {
      EXPECT_NEAR(normal.dot(after_L - before_L[n]), 0.0, 1e-12);
    }
    if (n < std::size_t(quadratic.corner_count())) {
      EXPECT_EQ(after_L, before_L[n]);
    }
  }
}

TEST(FitMidEdgeNodes, FacesNamedStraightStayStraight) {
  const QuadraticMesh quadratic = elevate_order(dome(2));
  const CurvedMesh curved = fit_mid_edge_nodes(quadratic, sphere(), boundary_faces(quadratic.mesh));
  EXPECT_EQ(curved.quadratic.mesh.nodes_L, quadratic.mesh.nodes_L);
  EXPECT_EQ(curved.curved + curved.limited, 0);
}

TEST(FitMidEdgeNodes, NoElementIsInverted) {
  const QuadraticMesh quadratic =
      elevate_order(make_box(ElementShape::kTet4, {2, 2, 1}, {8, 8, 0.4}));
  // The surface is 0.5 mm below the upper side, below the body.
  const CurvedSurface sunk{[](const Vec3& p) { return p.z() < -0.1; },
                           [](const Vec3&) { return std::vector<Vec3>{}; }};
  const CurvedMesh curved = fit_mid_edge_nodes(quadratic, sunk);
  EXPECT_GT(curved.limited, 0);
  EXPECT_GE(curved.min_ratio, kMinJacobianRatio);
  const MeshQuality quality = measure_quality(curved.quadratic.mesh);
  EXPECT_TRUE(quality.inverted.empty());
}

}  // namespace
}  // namespace lefort::mesh::test_elevate_order
