#include <lefort/core/parallel.h>
#include <lefort/field/build_distance_field.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/tissue_boundary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "support/box_mesh.h"
#include "support/shapes.h"

namespace lefort::predict {
namespace {

constexpr double kSide_mm = 12.0;
constexpr double kHeight_mm = 9.0;

/// A block of tissue held at its top, lying on a slab of bone:
///
///      ////////   z = 9, fixed
///      | tissue|
///      |_______|  z = 0
///    |  segment   |
FaceModel block_on_slab() {
  FaceModel model;
  model.tissue = test::box_mesh({.cells = {6, 6, 5}, .size_mm = {kSide_mm, kSide_mm, kHeight_mm}});
  auto& node_sets = model.tissue.node_sets;
  node_sets[sets::kMovedBone] = node_sets.at("z0");
  node_sets[sets::kFixed] = node_sets.at("z1");
  for (const mesh::Face3& face : mesh::boundary_faces(model.tissue)) {
    const bool is_low = std::all_of(face.begin(), face.end(), [&](std::int32_t node) {
      return model.tissue.nodes_L[std::size_t(node)].z() < 1e-9;
    });
    if (is_low) model.tissue.face_sets[sets::kContact].push_back(face);
  }
  model.segment_B = test::make_box({-4.0, -4.0, -10.0}, {16.0, 16.0, 0.0});
  model.segment_field_B = std::make_shared<const field::DistanceField>(
      field::build_distance_field(model.segment_B, {.resolution = 64, .band_mm = 3.0, .smooth = true}).value());
  return model;
}

plan::BonePath straight(const Vec3& by_mm, int steps) {
  plan::BonePath path;
  path.segment = "slab";
  path.steps = steps;
  path.keyframes = {{.at = 1.0, .translation_mm = by_mm}};
  return path;
}

TEST(PredictFace, PushedTissueFollowsTheBoneButForTheStatedPenetration) {
  const FaceModel model = block_on_slab();
  const auto prediction = predict_face(model, straight({0.0, 0.0, 2.0}, 4), {}).value();
  ASSERT_TRUE(prediction.converged());
  ASSERT_EQ(prediction.steps.size(), 4U);
  for (const PredictionStep& step : prediction.steps) {
    EXPECT_LE(step.relative_residual, 1e-6);
    EXPECT_GT(step.smallest_J, 0.0);
    EXPECT_GT(step.contact.normal_force_n, 0.0);
    for (const std::int32_t node : model.tissue.node_sets.at(sets::kFixed))
      EXPECT_EQ(step.displacement_mm[std::size_t(node)], Vec3::Zero());
  }
  const PredictionStep& last = prediction.steps.back();
  EXPECT_GT(last.contact.max_penetration_mm, 0.0);
  EXPECT_LT(last.contact.max_penetration_mm, 0.5);
  for (const std::int32_t node : model.tissue.node_sets.at(sets::kMovedBone)) {
    const double up_mm = last.displacement_mm[std::size_t(node)].z();
    EXPECT_LT(up_mm, 2.0 + 0.1);
    EXPECT_GT(up_mm, 2.0 - 0.6);
  }
}

TEST(PredictFace, StifferContactLeavesLessPenetration) {
  const FaceModel model = block_on_slab();
  PredictionOptions stiff;
  stiff.contact.stiffness_factor = 100.0;
  const auto soft = predict_face(model, straight({0.0, 0.0, 1.0}, 2), {}).value();
  const auto hard = predict_face(model, straight({0.0, 0.0, 1.0}, 2), stiff).value();
  ASSERT_TRUE(soft.converged() && hard.converged());
  EXPECT_LT(hard.steps.back().contact.max_penetration_mm,
            0.3 * soft.steps.back().contact.max_penetration_mm);
}

TEST(PredictFace, StiffnessOfHomogeneousTissueDoesNotMatter) {  // domain: only ratios count.
  const FaceModel model = block_on_slab();
  PredictionOptions stiffer;
  stiffer.tissue.young_mpa *= 7.0;
  const auto one = predict_face(model, straight({0.0, 0.0, 1.0}, 2), {}).value();
  const auto seven = predict_face(model, straight({0.0, 0.0, 1.0}, 2), stiffer).value();
  ASSERT_TRUE(one.converged() && seven.converged());
  for (std::size_t n = 0; n < model.tissue.nodes_L.size(); ++n)
    EXPECT_LT((one.steps.back().displacement_mm[n] - seven.steps.back().displacement_mm[n]).norm(),
              1e-5);
  EXPECT_NEAR(seven.steps.back().contact.normal_force_n,
              7.0 * one.steps.back().contact.normal_force_n, 1e-4);
}

TEST(PredictFace, FrictionlessTissueDoesNotFollowABoneThatSlides) {
  const FaceModel model = block_on_slab();
  const auto prediction = predict_face(model, straight({2.0, 0.0, 0.0}, 2), {}).value();
  ASSERT_TRUE(prediction.converged());
  for (const Vec3& u : prediction.steps.back().displacement_mm) EXPECT_LT(u.norm(), 1e-3);
}

TEST(PredictFace, ARetreatingBoneLeavesTissueWhereItIs) {
  const FaceModel model = block_on_slab();
  const auto prediction = predict_face(model, straight({0.0, 0.0, -2.0}, 2), {}).value();
  ASSERT_TRUE(prediction.converged());
  for (const Vec3& u : prediction.steps.back().displacement_mm) EXPECT_EQ(u, Vec3::Zero());
}

TEST(PredictFace, AttachedTissueMovesExactlyWithTheBone) {
  const FaceModel model = block_on_slab();
  PredictionOptions options;
  options.boundary.moved_bone = MovedBone::kAttached;
  plan::BonePath path = straight({0.5, 0.0, -1.0}, 3);
  path.keyframes[0].rotation_rad = Vec3(0.0, 0.0, 0.1);
  path.keyframes[0].centre_L = Vec3(6.0, 6.0, 0.0);
  const auto prediction = predict_face(model, path, options).value();
  ASSERT_TRUE(prediction.converged());
  EXPECT_EQ(prediction.contact_stiffness_mpa_per_mm, 0.0);
  const PredictionStep& last = prediction.steps.back();
  for (const std::int32_t node : model.tissue.node_sets.at(sets::kMovedBone)) {
    const Vec3& X = model.tissue.nodes_L[std::size_t(node)];
    EXPECT_LT((X + last.displacement_mm[std::size_t(node)] - last.X_LB * X).norm(), 1e-12);
  }
}

TEST(PredictFace, SameBitsForAnyNumberOfThreads) {
  const FaceModel model = block_on_slab();
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return predict_face(model, straight({0.0, 0.3, 1.0}, 2), {}).value();
  };
  const auto one = with_threads(1), two = with_threads(2);
  ASSERT_TRUE(one.converged() && two.converged());
  EXPECT_EQ(one.steps.back().displacement_mm, two.steps.back().displacement_mm);
}

TEST(PredictFace, RefusesAStepTheFieldCannotSee) {
  const auto refused = predict_face(block_on_slab(), straight({0.0, 0.0, 7.0}, 2), {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kStepBeyondBand);
  EXPECT_NE(refused.error().message.find("at least 3 steps"), std::string::npos)
      << refused.error().message;
}

TEST(PredictFace, RefusesAModelThatNothingTouchesOrHolds) {
  FaceModel untouched = block_on_slab();
  untouched.tissue.node_sets[sets::kMovedBone].clear();
  EXPECT_EQ(predict_face(untouched, straight({0.0, 0.0, 1.0}, 1), {}).error().code,
            ErrorCode::kAnatomyMissing);
  FaceModel loose = block_on_slab();
  loose.tissue.node_sets[sets::kFixed].clear();
  EXPECT_EQ(predict_face(loose, straight({0.0, 0.0, 1.0}, 1), {}).error().code,
            ErrorCode::kAnatomyMissing);
}

TEST(PredictFace, APathThatCannotBeSolvedFailsWithoutAFace) {
  PredictionOptions hurried;
  hurried.solver.smallest_step = 1.0;
  hurried.solver.max_iterations = 1;
  const auto prediction =
      predict_face(block_on_slab(), straight({0.0, 0.0, 2.0}, 2), hurried).value();
  ASSERT_FALSE(prediction.converged());
  EXPECT_EQ(prediction.failure->code, ErrorCode::kNotConverged);
  EXPECT_TRUE(prediction.steps.empty());
  EXPECT_FALSE(prediction.failed_attempts.empty());
}

/// Stops as soon as it is asked.
class StopAtOnce final : public Progress {
 public:
  [[nodiscard]] bool stop_requested() const override { return true; }
};

TEST(PredictFace, CanBeStopped) {
  StopAtOnce stop;
  const auto stopped = predict_face(block_on_slab(), straight({0.0, 0.0, 1.0}, 1), {}, {}, stop);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::predict
