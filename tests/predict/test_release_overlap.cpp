/// \file
/// A block of tissue between a segment above and stationary bone below: the segment moves down, and
/// part of it lies in the bone at the end.
#include <lefort/predict/predict_face.h>
#include <lefort/predict/release_overlap.h>

#include <gtest/gtest.h>

#include <vector>

#include "support/box_mesh.h"
#include "support/shapes.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_release_overlap {
namespace {

using test::kHeight_mm;
using test::kSide_mm;

constexpr double kSnap_mm = 0.8;

/// Tissue is bonded to the segment on top and to a step of stationary bone at the side x = 0, which
/// reaches up to half of the height.
FaceModel block_between_bones() {
  FaceModel model;
  model.tissue = test::box_mesh({.cells = {6, 6, 5}, .size_mm = {kSide_mm, kSide_mm, kHeight_mm}});
  auto& sets = model.tissue.node_sets;
  sets[sets::kMobilizedSegment] = sets.at("z1");
  sets[sets::kFixed] = sets.at("x1");
  model.tissue.face_sets[sets::kContact] = model.tissue.face_sets.at("z1");
  model.tissue.face_sets[sets::kStationaryContact] = model.tissue.face_sets.at("z0");
  model.segments.push_back(
      test::moved(test::make_box({-4.0, -4.0, kHeight_mm}, {16.0, 16.0, kHeight_mm + 10.0})));
  model.stationary_bone = test::moved(test::make_box({8.0, -6.0, -10.0}, {22.0, 18.0, 7.0}));
  for (const std::int32_t node : sets.at("boundary")) {
    const Vec3& p_L = model.tissue.nodes_L[std::size_t(node)];
    NodeInterface one{.node = node};
    if (p_L.z() > kHeight_mm - 0.1)
      one = {.node = node,
             .condition = InterfaceCondition::kBonded,
             .rule = InterfaceRule::kSegment,
             .bone = 0};
    model.interface.nodes.push_back(one);
  }
  return model;
}

bool is_released(const NodeInterface& one) { return one.rule == InterfaceRule::kOverlap; }

TEST(ReleaseOverlap, FreesTissueOnBoneThatEntersOtherBoneAndNoOther) {
  FaceModel model = block_between_bones();
  const std::size_t faces = model.tissue.face_sets.at(sets::kContact).size();
  const geometry::RigidPath down = test::straight({0.0, 0.0, -4.0}, 4);
  const Index count = release_overlap(model, {&down, 1}, kSnap_mm).value();
  EXPECT_GT(count, 0);
  Index seen = 0;
  for (const NodeInterface& one : model.interface.nodes) {
    const Vec3& p_L = model.tissue.nodes_L[std::size_t(one.node)];
    if (is_released(one)) {
      ++seen;
      EXPECT_EQ(one.condition, InterfaceCondition::kFree);
      EXPECT_EQ(one.bone, kNoBone);
      EXPECT_GT(p_L.x(), 8.0 - kSide_mm / 6.0 - 0.1);  // Of the bone, and one element beyond.
    } else if (one.bone == 0) {
      EXPECT_LT(p_L.x(), 8.0 + kSnap_mm + 0.1);
    }
  }
  EXPECT_EQ(seen, count);
  EXPECT_LT(model.tissue.face_sets.at(sets::kContact).size(), faces);
}

TEST(ReleaseOverlap, ChangesNothingWhereBonesOnlyApproach) {
  FaceModel model = block_between_bones();
  const geometry::RigidPath down = test::straight({0.0, 0.0, -1.5}, 4);
  EXPECT_EQ(release_overlap(model, {&down, 1}, kSnap_mm).value(), 0);
  for (const NodeInterface& one : model.interface.nodes) EXPECT_FALSE(is_released(one));
}

TEST(ReleaseOverlap, KeepsPaint) {
  FaceModel model = block_between_bones();
  for (NodeInterface& one : model.interface.nodes) one.rule = InterfaceRule::kPainted;
  const geometry::RigidPath down = test::straight({0.0, 0.0, -4.0}, 4);
  EXPECT_EQ(release_overlap(model, {&down, 1}, kSnap_mm).value(), 0);
}

}  // namespace
}  // namespace lefort::predict::test_release_overlap
