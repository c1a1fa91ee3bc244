#include <lefort/solve/unconstrained_parts.h>

#include <gtest/gtest.h>

#include "support/box_mesh.h"

namespace lefort::solve::test_unconstrained_parts {
namespace {

using fem::PrescribedDisplacement;

std::vector<PrescribedDisplacement> prescribe(const std::vector<std::int32_t>& nodes,
                                              int component) {
  std::vector<PrescribedDisplacement> constrained;
  for (const std::int32_t node : nodes) constrained.push_back({node, component, 0.0});
  return constrained;
}

std::vector<PrescribedDisplacement> joined(
    std::initializer_list<std::vector<PrescribedDisplacement>> lists) {
  std::vector<PrescribedDisplacement> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// Two boxes that do not touch; the first element of the second one is number 48.
mesh::VolumeMesh two_boxes() {
  mesh::VolumeMesh mesh = test::box_mesh();
  const mesh::VolumeMesh other = test::box_mesh();
  for (const Vec3& p : other.nodes_L) mesh.nodes_L.emplace_back(p + Vec3(10, 0, 0));
  for (const std::int32_t node : other.blocks[0].nodes) mesh.blocks[0].nodes.push_back(node + 27);
  mesh.blocks[0].region.resize(96, 0);
  return mesh;
}

TEST(UnconstrainedParts, AFixedSideConstrainsTheBody) {
  const mesh::VolumeMesh mesh = test::box_mesh();
  EXPECT_TRUE(find_unconstrained_parts(mesh, fem::prescribe_zero(mesh.node_sets.at("z0"))).empty());
}

TEST(UnconstrainedParts, ThreeSymmetryPlanesConstrainTheBody) {
  const mesh::VolumeMesh mesh = test::box_mesh();
  EXPECT_TRUE(find_unconstrained_parts(mesh, joined({prescribe(mesh.node_sets.at("x0"), 0),
                                                     prescribe(mesh.node_sets.at("y0"), 1),
                                                     prescribe(mesh.node_sets.at("z0"), 2)}))
                  .empty());
}

TEST(UnconstrainedParts, ABodyThatSlidesOnOnePlaneHasThreeMotions) {
  const mesh::VolumeMesh mesh = test::box_mesh();
  const auto unconstrained = find_unconstrained_parts(mesh, prescribe(mesh.node_sets.at("z0"), 2));
  ASSERT_EQ(unconstrained.size(), 1U);
  EXPECT_EQ(unconstrained[0].free_motions, 3);
}

TEST(UnconstrainedParts, AFreeMotionIsDescribed) {
  const mesh::VolumeMesh mesh = test::box_mesh();
  const auto sliding = find_unconstrained_parts(
      mesh, joined({prescribe(mesh.node_sets.at("x0"), 0), prescribe(mesh.node_sets.at("z0"), 2)}));
  ASSERT_EQ(sliding.size(), 1U);
  EXPECT_EQ(sliding[0].free_motions, 1);
  EXPECT_TRUE(sliding[0].motion == "move along (0, 1, 0)" ||
              sliding[0].motion == "move along (0, -1, 0)")
      << sliding[0].motion;
  // Constrained only along its axis, a body rotates about it.
  const auto turning =
      find_unconstrained_parts(mesh, joined({fem::prescribe_zero(std::vector<std::int32_t>{0}),
                                             fem::prescribe_zero(std::vector<std::int32_t>{18})}));
  ASSERT_EQ(turning.size(), 1U);
  EXPECT_EQ(turning[0].free_motions, 1);
  EXPECT_NE(turning[0].motion.find("rotate about (0, 0, "), std::string::npos) << turning[0].motion;
}

TEST(UnconstrainedParts, AnUnconstrainedPartIsReportedByElementAndPosition) {
  const mesh::VolumeMesh mesh = two_boxes();
  const auto unconstrained =
      find_unconstrained_parts(mesh, fem::prescribe_zero(mesh.node_sets.at("z0")));
  ASSERT_EQ(unconstrained.size(), 1U);
  EXPECT_EQ(unconstrained[0].first_element, 48);
  EXPECT_EQ(unconstrained[0].elements, 48);
  EXPECT_EQ(unconstrained[0].free_motions, 6);
  EXPECT_NEAR(unconstrained[0].at_L.x(), 10.25, 0.25);
  EXPECT_EQ(unconstrained[0].nodes.front(), 27);
  EXPECT_EQ(unconstrained[0].nodes.size(), 27U);
}

}  // namespace
}  // namespace lefort::solve::test_unconstrained_parts
