#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/open_slit.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "shapes_of_tets.h"

namespace lefort::test {
namespace {

using mesh::SlitMesh;

/// A block of size 6: a slit at height z from the side y = 0 to y = `depth`.
mesh::SlitSurface slit_at(double z, double depth) {
  return {[z](const Vec3& p) { return p.z() - z; },
          [depth](const Vec3& p) { return depth - p.y(); }};
}

bool is_in_block(const Vec3& p) { return p.minCoeff() > 0.0 && p.maxCoeff() < 6.0; }

mesh::VolumeMesh block() { return cube_of_tets(6); }

TEST(OpenSlit, opens_a_mesh_that_has_faces_in_the_slit) {
  const SlitMesh slit = mesh::open_slit(block(), slit_at(3.0, 4.0), is_in_block);
  EXPECT_NEAR(slit.area_mm2, 24.0, 1e-12);
  // 7 columns of 4 nodes: those at y = 4 are on the border and stay single.
  EXPECT_EQ(slit.pairs.size(), 28u);
  EXPECT_EQ(slit.mesh.nodes_L.size(), block().nodes_L.size() + 28u);
  double area = 0.0;
  for (const auto& [first, second, mm2] : slit.pairs) {
    EXPECT_EQ(slit.mesh.nodes_L[std::size_t(first)], slit.mesh.nodes_L[std::size_t(second)]);
    EXPECT_LT(slit.mesh.nodes_L[std::size_t(first)].y(), 3.5);
    EXPECT_EQ(slit.mesh.nodes_L[std::size_t(first)].z(), 3.0);
    area += mm2;
  }
  EXPECT_GT(area, 20.0);
  EXPECT_LT(area, 24.0);
  EXPECT_EQ(slit.rms_distance_mm, 0.0);
}

TEST(OpenSlit, faces_are_boundary_faces_that_look_at_each_other) {
  const SlitMesh slit = mesh::open_slit(block(), slit_at(3.0, 4.0), is_in_block);
  const auto boundary = mesh::boundary_faces(slit.mesh);
  EXPECT_EQ(boundary.size(), mesh::boundary_faces(block()).size() + slit.first_faces.size() +
                                 slit.second_faces.size());
  const auto normal_z = [&](const mesh::Face& face) {
    const auto p = [&](std::size_t n) { return slit.mesh.nodes_L[std::size_t(face.nodes[n])]; };
    return (p(1) - p(0)).cross(p(2) - p(0)).z();
  };
  for (const mesh::Face& face : slit.first_faces) EXPECT_LT(normal_z(face), 0.0);
  for (const mesh::Face& face : slit.second_faces) EXPECT_GT(normal_z(face), 0.0);
}

TEST(OpenSlit, splits_a_body_in_two_where_it_has_no_border) {
  const SlitMesh slit = mesh::open_slit(block(), slit_at(3.0, 100.0), is_in_block);
  EXPECT_EQ(slit.pairs.size(), 49u);
  std::set<std::int32_t> above, below;
  const mesh::ElementBlock& tets = slit.mesh.blocks[0];
  for (Index e = 0; e < tets.element_count(); ++e) {
    double z = 0.0;
    for (int n = 0; n < 4; ++n) z += slit.mesh.nodes_L[std::size_t(tets.element(e)[n])].z() / 4.0;
    (z > 3.0 ? above : below).insert(tets.element(e), tets.element(e) + 4);
  }
  std::vector<std::int32_t> both;
  std::set_intersection(above.begin(), above.end(), below.begin(), below.end(),
                        std::back_inserter(both));
  EXPECT_TRUE(both.empty());
}

TEST(OpenSlit, an_irregular_mesh_keeps_its_volume_and_its_elements_are_valid) {
  std::mt19937 random(7);
  const mesh::VolumeMesh before = mesh::with_inner_nodes_moved(block(), {0.15, 0.15, 0.15}, random);
  // An inclined slit; no face lies in it.
  const mesh::SlitSurface surface{
      [](const Vec3& p) { return (p.z() - 2.8 - 0.1 * p.x()) / std::sqrt(1.01); },
      [](const Vec3& p) { return 3.7 - p.y(); }};
  const SlitMesh slit = mesh::open_slit(before, surface, is_in_block);
  const auto quality = mesh::measure_quality(slit.mesh);
  EXPECT_TRUE(quality.inverted.empty());
  EXPECT_GE(quality.min_scaled_jacobian, 0.1);
  EXPECT_NEAR(quality.volume_mm3, 216.0, 0.5);
  EXPECT_EQ(quality.elements, before.element_count());
  EXPECT_GT(slit.pairs.size(), 20u);
  EXPECT_LT(slit.rms_distance_mm, 0.25);  // 0.5 without moving nodes.
  EXPECT_NEAR(slit.area_mm2, 6.0 * 3.7, 4.0);
}

TEST(OpenSlit, is_the_same_each_time) {
  const auto once = [] { return mesh::open_slit(block(), slit_at(2.6, 3.3), is_in_block); };
  const SlitMesh a = once(), b = once();
  EXPECT_EQ(a.mesh.nodes_L, b.mesh.nodes_L);
  EXPECT_EQ(a.mesh.blocks[0].nodes, b.mesh.blocks[0].nodes);
  EXPECT_EQ(a.first_faces, b.first_faces);
}

TEST(OpenSlit, opens_wedges_and_hexahedra) {
  for (const auto shape : {mesh::ElementShape::kWedge6, mesh::ElementShape::kHex8}) {
    mesh::VolumeMesh box = mesh::make_box(shape, {6, 6, 6}, {6, 6, 6});
    box.node_sets.clear();
    box.face_sets.clear();
    const SlitMesh slit = mesh::open_slit(box, slit_at(3.0, 4.0), is_in_block);
    EXPECT_EQ(slit.pairs.size(), 28u);
    EXPECT_NEAR(slit.area_mm2, 24.0, 1e-12);
  }
}

TEST(OpenSlit, does_nothing_without_elements_on_both_sides) {
  const SlitMesh outside = mesh::open_slit(block(), slit_at(9.0, 4.0), is_in_block);
  EXPECT_TRUE(outside.pairs.empty());
  EXPECT_TRUE(outside.first_faces.empty());
  EXPECT_EQ(outside.mesh.blocks[0].nodes, block().blocks[0].nodes);
  // A part below a hundredth of the elements stays joined: a corner of one cube.
  const mesh::SlitSurface corner{[](const Vec3& p) { return p.sum() - 0.8; },
                                 [](const Vec3&) { return 1.0; }};
  EXPECT_TRUE(mesh::open_slit(block(), corner, is_in_block).pairs.empty());
}

}  // namespace
}  // namespace lefort::test
