#include <lefort/fem/locking/elements_in_thick_parts.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "support/box_mesh.h"

namespace lefort::fem::test_elements_in_thick_parts {
namespace {

using mesh::ElementShape;

auto count_of(const mesh::VolumeMesh& mesh) {
  const std::vector<char> flags = elements_in_thick_parts(mesh);
  EXPECT_EQ(Index(flags.size()), mesh.element_count());
  return std::ranges::count(flags, 1);
}

TEST(ElementsWithInteriorNodes, NoneInASingleLayerAndAllInTwo) {
  for (const ElementShape shape : {ElementShape::kTet10, ElementShape::kWedge15}) {
    EXPECT_EQ(count_of(test::box_mesh({.cells = {4, 4, 1}, .shape = shape})), 0);
    const auto two = test::box_mesh({.cells = {4, 4, 2}, .shape = shape});
    EXPECT_EQ(count_of(two), two.element_count());
  }
}

TEST(ElementsWithInteriorNodes, AThinPartOfAThickBodyIsALayer) {
  // A row of ten cubes, one thick, on the side of a block of 3 x 3 x 3.
  mesh::VolumeMesh body =
      test::box_mesh({.cells = {13, 3, 3}, .size_mm = {13, 3, 3}, .shape = ElementShape::kWedge15});
  mesh::ElementBlock& block = body.blocks.front();
  mesh::ElementBlock kept{.shape = block.shape, .nodes = {}, .region = {}};
  std::vector<double> at_x_mm;
  for (Index e = 0; e < block.element_count(); ++e) {
    Vec3 middle = Vec3::Zero();
    for (int a = 0; a < 6; ++a) middle += body.nodes_L[std::size_t(block.element(e)[a])] / 6.0;
    if (middle.x() > 3.0 && (middle.y() > 1.0 || middle.z() > 1.0)) continue;
    kept.nodes.insert(kept.nodes.end(), block.element(e),
                      block.element(e) + mesh::node_count(block.shape));
    kept.region.push_back(0);
    at_x_mm.push_back(middle.x());
  }
  block = std::move(kept);
  const std::vector<char> flags = elements_in_thick_parts(body);
  ASSERT_EQ(flags.size(), at_x_mm.size());
  for (std::size_t e = 0; e < flags.size(); ++e) {
    // Elements of the row next to the block share corners with elements that have interior nodes.
    const bool touches = at_x_mm[e] > 3.0 && at_x_mm[e] < 4.0;
    if (touches) continue;
    EXPECT_EQ(flags[e], char(at_x_mm[e] < 3.0)) << at_x_mm[e];
  }
}

TEST(ElementsWithInteriorNodes, BlocksAreNumberedThrough) {
  // A separate layer of tet10.
  mesh::VolumeMesh both = test::box_mesh({.cells = {2, 2, 2}, .shape = ElementShape::kWedge15});
  const mesh::VolumeMesh layer =
      test::box_mesh({.cells = {3, 3, 1}, .shape = ElementShape::kTet10});
  const auto first_node = std::int32_t(both.node_count());
  both.nodes_L.insert(both.nodes_L.end(), layer.nodes_L.begin(), layer.nodes_L.end());
  both.blocks.push_back(layer.blocks.front());
  for (std::int32_t& node : both.blocks.back().nodes) node += first_node;
  const std::vector<char> flags = elements_in_thick_parts(both);
  ASSERT_EQ(Index(flags.size()), both.element_count());
  const auto end_of_first = flags.begin() + both.blocks.front().element_count();
  EXPECT_EQ(std::count(flags.begin(), end_of_first, 1), both.blocks.front().element_count());
  EXPECT_EQ(std::count(end_of_first, flags.end(), 1), 0);
}

TEST(ElementsWithInteriorNodes, IsEmptyIfNoShapeNeedsIt) {
  EXPECT_TRUE(elements_in_thick_parts(test::box_mesh({.cells = {2, 2, 2}})).empty());
}

}  // namespace
}  // namespace lefort::fem::test_elements_in_thick_parts
