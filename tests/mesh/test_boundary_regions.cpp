#include <lefort/core/check.h>
#include <lefort/mesh/boundary_regions.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "mesh/shapes_of_tets.h"

namespace lefort::mesh::test_boundary_regions {
namespace {

/// A cube of side 4 with rules for its floor, its wall x = 0, and one that applies nowhere.
VolumeMesh named_cube() {
  const std::array<BoundaryRule, 3> rules{
      {{"floor", [](const Vec3& p) { return p.z(); }, 0.1},
       {"wall", [](const Vec3& p) { return p.x(); }, 0.1},
       {"nowhere", [](const Vec3&) { return std::numeric_limits<double>::quiet_NaN(); }, 1e9}}};
  return name_boundary(test::cube_of_tets(4), rules, "skin");
}

TEST(NameBoundary, NodeBelongsToTheFirstRuleThatApplies) {
  const VolumeMesh mesh = named_cube();
  EXPECT_EQ(mesh.node_sets.at("floor").size(), 25u);
  EXPECT_EQ(mesh.node_sets.at("wall").size(), 20u);
  for (const std::int32_t node : mesh.node_sets.at("wall"))
    EXPECT_GT(mesh.nodes_L[std::size_t(node)].z(), 0.5);
  EXPECT_TRUE(mesh.node_sets.at("nowhere").empty());
}

TEST(NameBoundary, SetsPartitionTheBoundary) {
  const VolumeMesh mesh = named_cube();
  std::size_t nodes = 0, faces = 0;
  for (const char* name : {"floor", "wall", "nowhere", "skin"}) {
    nodes += mesh.node_sets.at(name).size();
    faces += mesh.face_sets.at(name).size();
  }
  EXPECT_EQ(nodes, mesh.node_sets.at("boundary").size());
  EXPECT_EQ(faces, mesh.face_sets.at("boundary").size());
  EXPECT_EQ(nodes, 98u);
  EXPECT_EQ(faces, 192u);
}

TEST(NameBoundary, FaceBelongsToTheRuleOfMostOfItsNodes) {
  const VolumeMesh mesh = named_cube();
  const auto is_in = [&](const char* name, std::int32_t node) {
    const auto& nodes = mesh.node_sets.at(name);
    return std::binary_search(nodes.begin(), nodes.end(), node);
  };
  std::array<int, 4> faces_with{};
  for (const Face& face : mesh.face_sets.at("floor")) {
    int mine = 0;
    for (const std::int32_t node : nodes_of(face)) mine += int(is_in("floor", node));
    ++faces_with[std::size_t(mine)];
  }
  EXPECT_EQ(faces_with[3], 32);  // The whole floor, ...
  EXPECT_EQ(faces_with[2], 16);  // ... one face on each edge of its border, ...
  EXPECT_EQ(faces_with[1], 2);   // ... and where floor, wall and skin meet.
  EXPECT_EQ(faces_with[0], 0);
}

TEST(NameBoundary, FaceOfThreeDifferentRulesBelongsToTheFirst) {
  const std::array<BoundaryRule, 2> rules{
      {{"first", [](const Vec3& p) { return p.x(); }, 0.6},
       {"second", [](const Vec3& p) { return p.y() - 0.5; }, 0.0}}};
  VolumeMesh mesh = test::tets({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}, {0, 1, 2, 3});
  mesh = name_boundary(mesh, rules);
  EXPECT_EQ(mesh.node_sets.at("first"), (std::vector<std::int32_t>{0}));
  EXPECT_EQ(mesh.node_sets.at("second"), (std::vector<std::int32_t>{1}));
  EXPECT_EQ(mesh.node_sets.at("free"), (std::vector<std::int32_t>{2, 3}));
  EXPECT_EQ(mesh.face_sets.at("free").size(), 2u);   // With 2 and 3.
  EXPECT_EQ(mesh.face_sets.at("first").size(), 2u);  // 0, 1 and one of 2 and 3.
}

TEST(NameBoundary, PointsInsideASignedDistanceBelong) {
  const std::array<BoundaryRule, 1> rules{
      {{"bone", [](const Vec3& p) { return p.z() - 2.0; }, 0.0}}};
  const VolumeMesh mesh = name_boundary(test::cube_of_tets(4), rules);
  EXPECT_EQ(mesh.node_sets.at("bone").size(), 25u + 2u * 16u);
}

TEST(NameBoundary, NamesMustBeDistinct) {
  const auto anywhere = [](const Vec3&) { return 0.0; };
  const std::array<BoundaryRule, 2> twice{{{"skin", anywhere, 0.0}, {"skin", anywhere, 0.0}}};
  EXPECT_THROW(static_cast<void>(name_boundary(test::cube_of_tets(1), twice)), LogicError);
  const std::array<BoundaryRule, 1> taken{{{"boundary", anywhere, 0.0}}};
  EXPECT_THROW(static_cast<void>(name_boundary(test::cube_of_tets(1), taken)), LogicError);
}

}  // namespace
}  // namespace lefort::mesh::test_boundary_regions
