#include <lefort/core/check.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/element_quality.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

namespace lefort::mesh::test_box_grid {
namespace {

const Vec3 kSize_mm(8, 6, 5);

/// All meshes that box_grid.h can make.
std::vector<VolumeMesh> all_boxes() {
  std::vector<VolumeMesh> boxes;
  for (const ElementShape shape :
       {ElementShape::kTet4, ElementShape::kPyramid5, ElementShape::kWedge6, ElementShape::kHex8,
        ElementShape::kTet10, ElementShape::kWedge15, ElementShape::kHex20})
    boxes.push_back(make_box(shape, {4, 3, 2}, kSize_mm));
  for (const BoxMix mix : {BoxMix::kAllLinear, BoxMix::kHex20Wedge15, BoxMix::kWedge15Tet10})
    boxes.push_back(make_mixed_box(mix, {5, 3, 3}, kSize_mm));
  return boxes;
}

/// Also: every interior face has an element on both sides, otherwise it would be boundary.
TEST(BoxGrid, IsClosedAndFillsTheBox) {
  for (const VolumeMesh& mesh : all_boxes()) {
    const geometry::TriangleMesh surface{mesh.nodes_L, triangles_of(boundary_faces(mesh))};
    EXPECT_TRUE(geometry::is_closed(surface));
    EXPECT_NEAR(geometry::signed_volume_mm3(surface), 240.0, 1e-11);
    EXPECT_NEAR(geometry::area_mm2(surface), 236.0, 1e-11);
  }
}

TEST(BoxGrid, UsesEveryNodeAndNoElementIsPoor) {
  for (const VolumeMesh& mesh : all_boxes()) {
    std::vector<char> is_used(mesh.nodes_L.size(), 0);
    for (const ElementBlock& block : mesh.blocks)
      for (const std::int32_t node : block.nodes) is_used[std::size_t(node)] = 1;
    EXPECT_EQ(std::count(is_used.begin(), is_used.end(), 0), 0);
    EXPECT_TRUE(poor_elements(mesh, 0.1).empty());
  }
}

TEST(BoxGrid, MixedBoxHasAllDocumentedShapes) {
  const auto fractions = [](BoxMix mix, std::array<int, 3> cells) {
    std::map<ElementShape, Index> count;
    for (const ElementBlock& block : make_mixed_box(mix, cells, kSize_mm).blocks)
      count[block.shape] += block.element_count();
    return count;
  };
  using Counts = std::map<ElementShape, Index>;
  EXPECT_EQ(fractions(BoxMix::kAllLinear, {4, 1, 1}), (Counts{{ElementShape::kHex8, 1},
                                                              {ElementShape::kWedge6, 2},
                                                              {ElementShape::kPyramid5, 5},
                                                              {ElementShape::kTet4, 2 + 6}}));
  EXPECT_EQ(fractions(BoxMix::kHex20Wedge15, {2, 1, 1}),
            (Counts{{ElementShape::kHex20, 1}, {ElementShape::kWedge15, 2}}));
  EXPECT_EQ(fractions(BoxMix::kWedge15Tet10, {1, 1, 2}),
            (Counts{{ElementShape::kWedge15, 2}, {ElementShape::kTet10, 6}}));
}

TEST(BoxGrid, HasSetsOfItsSides) {
  for (const VolumeMesh& mesh : all_boxes()) {
    std::size_t faces = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const std::string name{"xyz"[axis], "01"[side]};
        const auto& of_side = mesh.face_sets.at(name);
        faces += of_side.size();
        EXPECT_EQ(nodes_of_faces(of_side), mesh.node_sets.at(name));
        Vec3 area = Vec3::Zero();
        for (const auto& [a, b, c] : triangles_of(of_side)) {
          const Vec3& p = mesh.nodes_L[std::size_t(a)];
          area += 0.5 * (mesh.nodes_L[std::size_t(b)] - p).cross(mesh.nodes_L[std::size_t(c)] - p);
        }
        const Vec3 out = (side == 0 ? -1.0 : 1.0) * Vec3::Unit(axis);
        EXPECT_LT((area - kSize_mm.prod() / kSize_mm[axis] * out).norm(), 1e-12) << name;
      }
    EXPECT_EQ(faces, mesh.face_sets.at("boundary").size());
  }
}

TEST(BoxGrid, MovesInteriorNodesOnlyAndKeepsEdgesStraight) {
  for (const VolumeMesh& mesh : all_boxes()) {
    std::mt19937 random(3);
    const VolumeMesh moved = with_inner_nodes_moved(mesh, Vec3::Constant(0.2), random);
    for (const std::int32_t node : mesh.node_sets.at("boundary"))
      EXPECT_EQ(moved.nodes_L[std::size_t(node)], mesh.nodes_L[std::size_t(node)]);
    EXPECT_NE(moved.nodes_L, mesh.nodes_L);
    EXPECT_TRUE(poor_elements(moved, 0.0).empty());
    for (const ElementBlock& block : moved.blocks) {
      if (node_count(block.shape) == corner_count(block.shape)) continue;
      const std::int32_t* node = block.element(block.element_count() / 2);
      int middle = corner_count(block.shape);
      const auto at = [&](int n) { return moved.nodes_L[std::size_t(node[n])]; };
      for (const auto& [i, j] : edges_of(block.shape))
        EXPECT_LT((at(middle++) - 0.5 * (at(i) + at(j))).norm(), 1e-14);
    }
  }
}

TEST(BoxGrid, RejectsBoxesWithoutCells) {
  EXPECT_THROW(static_cast<void>(make_box(ElementShape::kHex8, {1, 0, 1}, kSize_mm)), LogicError);
  EXPECT_THROW(static_cast<void>(make_mixed_box(BoxMix::kAllLinear, {3, 1, 1}, kSize_mm)),
               LogicError);
}

}  // namespace
}  // namespace lefort::mesh::test_box_grid
