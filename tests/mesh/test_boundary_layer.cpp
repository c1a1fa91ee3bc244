#include <lefort/core/parallel.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_layer.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/generate_tets.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_boundary_layer {
namespace {

constexpr double kSide_mm = 6.0;

/// A cube of 6 x 6 x 6 whose top is to be covered.
const VolumeMesh& cube() {
  static const VolumeMesh mesh = test::cube_of_tets(int(kSide_mm));
  return mesh;
}

std::vector<Face> faces_where(const VolumeMesh& mesh, const std::function<bool(const Vec3&)>& on) {
  std::vector<Face> faces;
  for (const Face& face : boundary_faces(mesh)) {
    const auto nodes = nodes_of(face);
    if (std::all_of(nodes.begin(), nodes.end(),
                    [&](std::int32_t node) { return on(mesh.nodes_L[std::size_t(node)]); }))
      faces.push_back(face);
  }
  return faces;
}

std::vector<Face> top() {
  return faces_where(cube(), [](const Vec3& p) { return p.z() == kSide_mm; });
}

/// The four vertical sides.
std::vector<HalfSpace> upright_sides() {
  return {{Vec3::Zero(), Vec3::UnitX()},
          {Vec3::Zero(), Vec3::UnitY()},
          {Vec3::Constant(kSide_mm), -Vec3::UnitX()},
          {Vec3::Constant(kSide_mm), -Vec3::UnitY()}};
}

std::map<ElementShape, Index> count_shapes(const VolumeMesh& mesh) {
  std::map<ElementShape, Index> counts;
  for (const ElementBlock& block : mesh.blocks) counts[block.shape] += block.element_count();
  return counts;
}

double volume_of_region(const VolumeMesh& mesh, std::int32_t region) {
  double volume_mm3 = 0.0;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      if (block.region[std::size_t(e)] != region) continue;
      std::vector<Vec3> nodes;
      for (int n = 0; n < node_count(block.shape); ++n)
        nodes.push_back(mesh.nodes_L[std::size_t(block.element(e)[n])]);
      volume_mm3 += volume_of(block.shape, nodes);
    }
  return volume_mm3;
}

/// The boundary triangles by the positions of their corners, including those of hanging nodes.
std::multiset<std::array<double, 9>> surface_of(const VolumeMesh& mesh) {
  std::multiset<std::array<double, 9>> surface;
  for (const Face& face : boundary_faces(mesh)) {
    EXPECT_EQ(face.shape, FaceShape::kTri3);
    std::array<std::array<double, 3>, 3> corners{};
    for (std::size_t n = 0; n < 3; ++n) {
      const Vec3& p = mesh.nodes_L[std::size_t(face.nodes[n])];
      corners[n] = {p.x(), p.y(), p.z()};
    }
    std::sort(corners.begin(), corners.end());
    std::array<double, 9> flat{};
    for (std::size_t n = 0; n < 9; ++n) flat[n] = corners[n / 3][n % 3];
    surface.insert(flat);
  }
  return surface;
}

TEST(BoundaryLayer, FlatTopGetsWedgesThatEndInTheCutPlanes) {
  const BoundaryLayerOptions options{.thickness_mm = 1.2, .layers = 3, .region = 7};
  const VolumeMesh mesh = add_boundary_layer(cube(), top(), upright_sides(), options).value();
  const auto counts = count_shapes(mesh);
  EXPECT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts.at(ElementShape::kTet4), cube().element_count());
  EXPECT_EQ(counts.at(ElementShape::kWedge6), 3 * 2 * 36);
  EXPECT_NEAR(volume_of_region(mesh, 7), 36.0 * 1.2, 1e-12);
  EXPECT_NEAR(volume_of_region(mesh, 0), 36.0 * 4.8, 1e-12);
  EXPECT_TRUE(poor_elements(mesh, options.min_scaled_jacobian).empty());

  // Conforming: all boundary faces lie on the sides of the cube, and the top is unchanged.
  Index quads = 0, top_faces = 0;
  for (const Face& face : boundary_faces(mesh)) {
    quads += Index(face.shape == FaceShape::kQuad4);
    const auto nodes = nodes_of(face);
    const auto all_on = [&](const Vec3& normal, double at) {
      return std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t node) {
        return std::abs(normal.dot(mesh.nodes_L[std::size_t(node)]) - at) < 1e-12;
      });
    };
    int planes = 0;
    for (int axis = 0; axis < 3; ++axis)
      planes += int(all_on(Vec3::Unit(axis), 0.0)) + int(all_on(Vec3::Unit(axis), kSide_mm));
    EXPECT_EQ(planes, 1);
    top_faces += Index(all_on(Vec3::UnitZ(), kSide_mm));
  }
  EXPECT_EQ(quads, 3 * 4 * 6);
  EXPECT_EQ(top_faces, 2 * 36);
}

TEST(BoundaryLayer, HasFullThicknessAtApproximatelyPlanarCuts) {
  VolumeMesh rough = cube();
  int n = 0;
  for (Vec3& p : rough.nodes_L)
    for (const Index axis : {0, 1})
      if (p[axis] == 0.0 || p[axis] == kSide_mm) p[axis] += 0.03 * (n++ % 3 - 1);
  const std::vector<Face> skin =
      faces_where(rough, [](const Vec3& p) { return p.z() == kSide_mm; });
  const VolumeMesh mesh =
      add_boundary_layer(rough, skin, upright_sides(), {.thickness_mm = 1.5, .layers = 1}).value();
  EXPECT_EQ(count_shapes(mesh)[ElementShape::kWedge6], std::ssize(skin));
  EXPECT_NEAR(volume_of_region(mesh, 1), 1.5 * kSide_mm * kSide_mm, 0.5);
}

TEST(BoundaryLayer, EndsInPyramidsAndTetrahedraAtOtherBoundary) {
  const VolumeMesh mesh = add_boundary_layer(cube(), top(), {}, {.thickness_mm = 0.8}).value();
  const auto counts = count_shapes(mesh);
  // A triangle has three, two, one or no nodes on the border, whatever the directions of the
  // diagonals. In a corner square, each triangle has one node off the border, or one has none.
  Index by_rim_nodes[4] = {0, 0, 0, 0};
  for (const Face& face : top()) {
    const auto nodes = nodes_of(face);
    ++by_rim_nodes[std::count_if(nodes.begin(), nodes.end(), [](std::int32_t node) {
      const Vec3& p = cube().nodes_L[std::size_t(node)];
      return p.head<2>().minCoeff() == 0.0 || p.head<2>().maxCoeff() == kSide_mm;
    })];
  }
  EXPECT_EQ(counts.at(ElementShape::kWedge6), 2 * by_rim_nodes[0]);
  EXPECT_EQ(counts.at(ElementShape::kPyramid5), 2 * by_rim_nodes[1]);
  EXPECT_EQ(counts.at(ElementShape::kTet4), cube().element_count() + 2 * by_rim_nodes[2]);
  EXPECT_EQ(surface_of(mesh), surface_of(cube()));
  EXPECT_NEAR(volume_of_region(mesh, 0) + volume_of_region(mesh, 1), 216.0, 1e-11);
  EXPECT_TRUE(poor_elements(mesh, 0.05).empty());
}

TEST(BoundaryLayer, KeepsTheSurfaceOfABallAndHasTheThickness) {
  constexpr double kRadius_mm = 15.0, kThickness_mm = 1.5;
  const Vec3 center(0.31, -0.23, 0.17);
  const VolumeMesh ball =
      generate_tets([&](const Vec3& p) { return kRadius_mm - (p - center).norm(); },
                    Box3(Vec3::Constant(-18.0), Vec3::Constant(18.0)),
                    {.element_size_mm = 3.0, .min_scaled_jacobian = 0.12})
          .value();
  const std::vector<Face> skin = boundary_faces(ball);
  const VolumeMesh mesh =
      add_boundary_layer(ball, skin, {}, {.thickness_mm = kThickness_mm, .layers = 2}).value();
  EXPECT_EQ(count_shapes(mesh).at(ElementShape::kWedge6), 2 * Index(skin.size()));
  EXPECT_EQ(count_shapes(mesh).count(ElementShape::kPyramid5), 0U);
  EXPECT_EQ(surface_of(mesh), surface_of(ball));
  const double before_mm3 = measure_quality(ball).volume_mm3;
  EXPECT_NEAR(measure_quality(mesh).volume_mm3, before_mm3, 1e-9 * before_mm3);
  EXPECT_GE(measure_quality(mesh).min_scaled_jacobian, 0.05);
  EXPECT_TRUE(measure_quality(mesh).inverted.empty());
  for (const std::int32_t node : nodes_of_faces(skin)) {  // At the bottom of the layer now.
    const double depth_mm = kRadius_mm - (mesh.nodes_L[std::size_t(node)] - center).norm();
    EXPECT_NEAR(depth_mm, kThickness_mm, 0.03);
  }
}

TEST(BoundaryLayer, TakesAtMostAThirdOfAThinSheetFromEachSide) {
  VolumeMesh sheet = test::cube_of_tets(6);
  for (Vec3& p : sheet.nodes_L) p.z() *= 0.6;  // 3.6 mm.
  const std::vector<Face> skin =
      faces_where(sheet, [](const Vec3& p) { return p.z() < 1e-9 || p.z() > 3.6 - 1e-9; });
  const VolumeMesh mesh =
      add_boundary_layer(sheet, skin, upright_sides(), {.thickness_mm = 1.5, .layers = 1}).value();
  const double skin_mm3 = volume_of_region(mesh, 1);
  EXPECT_LE(skin_mm3, 2.0 * 36.0 * 1.2 + 1e-9);
  EXPECT_GE(skin_mm3, 2.0 * 36.0 * 1.15);
  EXPECT_NEAR(skin_mm3 + volume_of_region(mesh, 0), 36.0 * 3.6, 1e-9);
  EXPECT_GE(measure_quality(mesh).min_scaled_jacobian, 0.05);
}

TEST(BoundaryLayer, GetsThinnerInsteadOfInvertingElements) {
  // A sharp ridge: its sides are inclined towards each other, so that there is no room for a layer.
  VolumeMesh roof = test::cube_of_tets(6);
  for (Vec3& p : roof.nodes_L) p.x() = 3.0 + (p.x() - 3.0) * (1.0 - 0.12 * p.z());
  const std::vector<Face> skin = faces_where(roof, [](const Vec3& p) { return p.z() > 0.5; });
  const VolumeMesh mesh =
      add_boundary_layer(roof, skin, {}, {.thickness_mm = 0.4, .layers = 1}).value();
  EXPECT_EQ(surface_of(mesh), surface_of(roof));
  const MeshQuality quality = measure_quality(mesh);
  EXPECT_TRUE(quality.inverted.empty());
  const double before_mm3 = measure_quality(roof).volume_mm3;
  EXPECT_NEAR(quality.volume_mm3, before_mm3, 1e-9 * before_mm3);
  EXPECT_GT(volume_of_region(mesh, 1), 0.0);
}

TEST(BoundaryLayer, SameBitsForAnyNumberOfThreads) {
  const auto with_threads = [](int threads) {
    const ThreadLimit limit(threads);
    return add_boundary_layer(cube(), top(), upright_sides()).value();
  };
  const VolumeMesh one = with_threads(1), two = with_threads(2);
  EXPECT_EQ(one.nodes_L, two.nodes_L);
  ASSERT_EQ(one.blocks.size(), two.blocks.size());
  for (std::size_t b = 0; b < one.blocks.size(); ++b)
    EXPECT_EQ(one.blocks[b].nodes, two.blocks[b].nodes);
}

TEST(BoundaryLayer, RejectsInvalidOptions) {
  for (const BoundaryLayerOptions& options :
       {BoundaryLayerOptions{.thickness_mm = 0.0}, BoundaryLayerOptions{.layers = 0},
        BoundaryLayerOptions{.layers = 9}, BoundaryLayerOptions{.min_scaled_jacobian = 0.6}})
    EXPECT_EQ(add_boundary_layer(cube(), top(), {}, options).error().code,
              ErrorCode::kInvalidArgument);
}

TEST(CutFace, LiesInThePlaneOrIsInclinedLessThan45Degrees) {
  const std::vector<Vec3> nodes{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0.5, 1, 1}, {2, 1, 1}};
  const HalfSpace side{Vec3::Zero(), Vec3::UnitX()};
  EXPECT_TRUE(is_cut_face(nodes, {0, 1, 2}, side));
  EXPECT_FALSE(is_cut_face(nodes, {0, 2, 1}, side));  // Faces inwards.
  EXPECT_TRUE(is_cut_face(nodes, {2, 1, 3}, side) || is_cut_face(nodes, {1, 2, 3}, side));
  EXPECT_FALSE(is_cut_face(nodes, {2, 1, 4}, side) || is_cut_face(nodes, {1, 2, 4}, side));
  EXPECT_FALSE(is_cut_face(nodes, {0, 1, 2}, {Vec3(1, 0, 0), Vec3::UnitX()}));  // Elsewhere.
}

}  // namespace
}  // namespace lefort::mesh::test_boundary_layer
