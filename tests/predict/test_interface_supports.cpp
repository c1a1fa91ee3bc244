#include <lefort/predict/interface_supports.h>
#include <lefort/predict/predict_face.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "support/paper_boundary.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_interface_supports {
namespace {

using Condition = InterfaceCondition;
using test::kHeight_mm;
using test::kSide_mm;

TEST(InterfaceSupports, StiffnessOfALayer) {
  // E = 3 (1 - 2 nu) K and G = E / (2 (1 + nu)); k_n = (K + 4/3 G) / t, k_t = G / t.
  constexpr double kYoung = 0.015, kPoisson = 0.45;
  const double bulk = kYoung / (3.0 * (1.0 - 2.0 * kPoisson));
  const double shear = kYoung / (2.0 * (1.0 + kPoisson));
  for (const double thickness_mm : {0.5, 1.0, 20.0}) {
    const LayerStiffness layer = layer_stiffness(kYoung, kPoisson, thickness_mm);
    EXPECT_NEAR(layer.normal_mpa_per_mm, (bulk + 4.0 / 3.0 * shear) / thickness_mm, 1e-15);
    EXPECT_NEAR(layer.tangential_mpa_per_mm, shear / thickness_mm, 1e-15);
  }
  // The figures in docs/theory/interface.md.
  const LayerStiffness layer = layer_stiffness(kLayerYoung_mpa, kLayerPoisson, 1.0);
  EXPECT_NEAR(1e3 * layer.normal_mpa_per_mm, 47.0, 0.5);
  EXPECT_NEAR(layer_stiffness(0.015, 0.0, 1.0).normal_mpa_per_mm, 0.015, 1e-15);
}

/// The block of tissue_block.h with one condition for its lower side.
FaceModel block_with(Condition condition, std::int32_t bone = 0) {
  FaceModel model = test::block_on_slab();
  for (const std::int32_t node : model.tissue.node_sets.at("boundary"))
    model.interface.nodes.push_back({.node = node});
  const auto& bottom = model.tissue.node_sets.at("z0");
  for (NodeInterface& one : model.interface.nodes)
    if (std::binary_search(bottom.begin(), bottom.end(), one.node)) {
      one.condition = condition;
      one.bone = bone;
    }
  model.tissue.node_sets[sets::kBonded] = {};
  if (condition == Condition::kBonded) model.tissue.node_sets[sets::kBonded] = bottom;
  return model;
}

InterfaceSupports supports_of(const FaceModel& model) {
  return interface_supports(model.tissue, model.interface, 1, {}, {});
}

TEST(InterfaceSupports, OfElevatedTissueCoverItsAreaAlongTheNormalOutOfTheBone) {
  const FaceModel model = block_with(Condition::kElevated);
  const auto supports = supports_of(model).on_segments[0];
  ASSERT_EQ(supports.size(), model.tissue.node_sets.at("z0").size());
  double inner_mm2 = 0.0;
  for (const contact::NodalSupport& support : supports) {
    const Vec3& p = model.tissue.nodes_L[std::size_t(support.node)];
    EXPECT_EQ(support.normal_mpa_per_mm, 0.0);  // Contact alone resists compression.
    EXPECT_EQ(support.tension_mpa_per_mm, 0.0);
    EXPECT_EQ(support.tangential_mpa_per_mm, 0.0);
    EXPECT_TRUE(support.follows_surface);
    const bool is_inner =
        p.x() > 0.1 && p.x() < kSide_mm - 0.1 && p.y() > 0.1 && p.y() < kSide_mm - 0.1;
    if (!is_inner) continue;  // At an edge the normal is that of two sides.
    EXPECT_LT((support.normal_B - Vec3::UnitZ()).norm(), 1e-12);
    inner_mm2 += support.area_mm2;
  }
  EXPECT_NEAR(inner_mm2, 25.0 * 2.0 * 2.0, 1e-9);  // 5 x 5 nodes, 2 mm apart.
}

TEST(InterfaceSupports, OfSlidingTissueFollowTheSurfaceWithoutShear) {
  FaceModel model = block_with(Condition::kSliding, kStationaryBone);
  model.interface.nodes.front().may_separate = true;
  EXPECT_TRUE(slides_on_stationary_bone(model.interface));
  EXPECT_FALSE(slides_on_stationary_bone(block_with(Condition::kSliding).interface));
  EXPECT_TRUE(
      slides_on_stationary_bone(block_with(Condition::kElevated, kStationaryBone).interface));
  EXPECT_FALSE(
      slides_on_stationary_bone(block_with(Condition::kBonded, kStationaryBone).interface));
  const InterfaceSupports supports = supports_of(model);
  EXPECT_TRUE(supports.on_segments[0].empty());
  ASSERT_EQ(supports.on_stationary.size(), model.tissue.node_sets.at("z0").size());
  for (const contact::NodalSupport& support : supports.on_stationary) {
    EXPECT_TRUE(support.follows_surface);
    EXPECT_EQ(support.tangential_mpa_per_mm, 0.0);
    EXPECT_GT(support.normal_mpa_per_mm, 0.0);
    const bool may_separate = support.node == model.interface.nodes.front().node;
    EXPECT_EQ(support.tension_mpa_per_mm, may_separate ? 0.0 : support.normal_mpa_per_mm);
  }
}

TEST(InterfaceSupports, OfAPlaneAreARollerOrAFoundation) {
  const TissueOptions tissue;
  const BoundaryOptions boundary{.foundation_mm = 25.0};
  const LayerStiffness far = layer_stiffness(tissue.young_mpa, tissue.poisson, 25.0);
  for (const Condition condition : {Condition::kRoller, Condition::kFoundation}) {
    FaceModel model = block_with(condition, kNoBone);
    const std::int32_t node = model.tissue.node_sets.at("z0").front();
    model.interface.planes = {
        {.node = node, .normal_L = Vec3::UnitZ()},
        {.node = node, .normal_L = Vec3::UnitX(), .segment = 0, .motion_fraction = 0.25}};
    const InterfaceSupports supports =
        interface_supports(model.tissue, model.interface, 1, tissue, boundary);
    ASSERT_EQ(supports.on_planes.size(), 1U);
    ASSERT_EQ(supports.on_segments[0].size(), 1U);
    const bool is_roller = condition == Condition::kRoller;
    for (const contact::NodalSupport& one : {supports.on_planes[0], supports.on_segments[0][0]}) {
      EXPECT_NEAR(
          one.normal_mpa_per_mm,
          is_roller ? 1000.0 * tissue.young_mpa / tissue.element_size_mm : far.normal_mpa_per_mm,
          1e-12);
      EXPECT_EQ(one.tension_mpa_per_mm, one.normal_mpa_per_mm);
      EXPECT_EQ(one.tangential_mpa_per_mm, is_roller ? 0.0 : far.tangential_mpa_per_mm);
    }
    EXPECT_EQ(supports.on_segments[0][0].motion_fraction, 0.25);
    EXPECT_EQ(supports.on_segments[0][0].normal_B, Vec3::UnitX());
    EXPECT_EQ(supports.on_planes[0].motion_fraction, 0.0);
  }
}

/// Mean displacement of the lower side of the block.
Vec3 bottom_mm(const FaceModel& model, const std::vector<Vec3>& displacement_mm) {
  Vec3 sum = Vec3::Zero();
  const auto& nodes = model.tissue.node_sets.at("z0");
  for (const std::int32_t node : nodes) sum += displacement_mm[std::size_t(node)];
  return sum / double(nodes.size());
}

/// A segment that is pulled back takes bonded and sliding tissue along; elevated tissue and tissue
/// in contact stay.
TEST(InterfaceSupports, TissueFollowsASegmentThatIsPulledBackIfSomethingHoldsIt) {
  const Vec3 back_mm(0.0, 0.0, -1.0);
  const auto pulled = [&](const FaceModel& model, const PredictionOptions& options) {
    const auto prediction = predict_face(model, {test::straight(back_mm, 2)}, options).value();
    EXPECT_TRUE(prediction.converged()) << prediction.failure->message;
    return prediction.steps.back();
  };
  const FaceModel elevated_model = block_with(Condition::kElevated);
  const PredictionStep bonded = pulled(block_with(Condition::kBonded), {});
  const PredictionStep elevated = pulled(elevated_model, {});
  const PredictionStep contact = pulled(block_with(Condition::kContact), test::paper_options());
  EXPECT_LT((bottom_mm(elevated_model, bonded.displacement_mm) - back_mm).norm(), 1e-12);
  const PredictionStep sliding = pulled(block_with(Condition::kSliding), {});
  // Springs in series: 47 kPa/mm of the layer, and at most 6.3 kPa/mm (uniaxial strain) of the
  // tissue.
  EXPECT_LT(bottom_mm(elevated_model, sliding.displacement_mm).z(), -47.0 / (47.0 + 6.3));
  EXPECT_EQ(bottom_mm(elevated_model, elevated.displacement_mm), Vec3::Zero());
  EXPECT_EQ(bottom_mm(elevated_model, contact.displacement_mm), Vec3::Zero());
  EXPECT_EQ(elevated.segments[0].supports.nodes, 49);
  EXPECT_NEAR(elevated.segments[0].supports.max_opening_mm, 1.0, 0.02);
  EXPECT_EQ(contact.segments[0].supports.nodes, 0);
  EXPECT_EQ(elevated.stationary_supports.nodes, 0);
}

TEST(InterfaceSupports, SlidingAndElevatedTissueDoNotFollowTheMotionAlongTheBone) {
  const FaceModel sliding = block_with(Condition::kSliding),
                  elevated = block_with(Condition::kElevated),
                  held = block_with(Condition::kBonded);
  const auto moved = [&](const FaceModel& model, double up_mm) {
    const auto prediction =
        predict_face(model, {test::straight({1.0, 0.0, up_mm}, 2)}, PredictionOptions{}).value();
    EXPECT_TRUE(prediction.converged());
    return bottom_mm(model, prediction.steps.back().displacement_mm);
  };
  EXPECT_LT(moved(sliding, -0.5).z(), -0.4);
  EXPECT_LT(std::abs(moved(sliding, -0.5).x()), 0.1);
  EXPECT_GT(moved(held, -0.5).x(), 0.4);
  // Elevated tissue stays when the bone moves back, and is pushed when the bone comes.
  EXPECT_EQ(moved(elevated, -0.5), Vec3::Zero());
  EXPECT_GT(moved(elevated, 0.5).z(), 0.4);
  EXPECT_LT(std::abs(moved(elevated, 0.5).x()), 0.1);
}

}  // namespace
}  // namespace lefort::predict::test_interface_supports
