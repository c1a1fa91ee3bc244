#include <lefort/predict/face_preview.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "support/paper_boundary.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_face_preview {
namespace {

FacePreview preview_of(const FaceModel& model,
                       TissueInterface interface = TissueInterface::kContact) {
  BoundaryOptions boundary = test::paper_boundary();
  boundary.interface = interface;
  return FacePreview(
      make_preview_model(model, test::surface_of(model), {}, boundary, Vec3::Ones()).value());
}

RigidTransform shift(const Vec3& by_mm) {
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = by_mm;
  return pose;
}

/// Largest distance at the surface between a preview and a prediction [mm].
double distance_mm(const FaceModel& model, TissueInterface interface, const Vec3& by_mm) {
  PredictionOptions options = test::paper_options();
  options.boundary.interface = interface;
  const auto prediction = predict_face(model, {test::straight(by_mm, 2)}, options).value();
  EXPECT_TRUE(prediction.converged());
  const auto preview_mm =
      preview_of(model, interface).displacement_mm(std::array{shift(by_mm)}).value();
  double max_mm = 0.0;
  for (const mesh::Face& face : mesh::boundary_faces(model.tissue))
    for (const std::int32_t node : nodes_of(face))
      max_mm = std::max(max_mm, (preview_mm[std::size_t(node)] -
                                 prediction.steps.back().displacement_mm[std::size_t(node)])
                                    .norm());
  return max_mm;
}

TEST(FacePreview, NoMotionMovesNothing) {
  const auto u_mm = preview_of(test::block_on_slab())
                        .displacement_mm(std::array{RigidTransform::Identity()})
                        .value();
  for (const Vec3& u : u_mm) EXPECT_EQ(u, Vec3::Zero());
}

/// Skin has its own law: the same stiffness changes nothing, a larger one reduces the displacement.
TEST(FacePreview, UsesTheMaterialOfSkin) {
  TissueOptions options;
  const auto answer = [&](const FaceModel& model) {
    return FacePreview(make_preview_model(model, test::surface_of(model), options,
                                          test::paper_boundary(), Vec3::Ones())
                           .value())
        .displacement_mm(std::array{shift({0.0, 0.0, 1.0})})
        .value();
  };
  const auto whole = answer(test::block_on_slab());
  options.skin = SkinOptions{.young_mpa = options.young_mpa, .poisson = options.poisson};
  const auto same = answer(test::layered_block());
  options.skin->young_mpa *= 20.0;
  const auto stiff = answer(test::layered_block());
  double change_mm = 0.0;
  for (std::size_t n = 0; n < whole.size(); ++n) {
    EXPECT_LT((same[n] - whole[n]).norm(), 1e-9);
    change_mm = std::max(change_mm, (stiff[n] - whole[n]).norm());
  }
  EXPECT_GT(change_mm, 0.01);
}

TEST(FacePreview, OfBondedTissueIsThePredictionToFirstOrder) {
  const FaceModel model = test::block_on_slab();
  const double far_mm = distance_mm(model, TissueInterface::kBonded, {0.4, 0.2, 0.4});
  const double near_mm = distance_mm(model, TissueInterface::kBonded, {0.1, 0.05, 0.1});
  EXPECT_LT(far_mm, 0.1);
  EXPECT_LT(near_mm, 0.02);
}

/// Part of a side, away from the segment, is painted to move with it; the rest slides.
FaceModel painted_block() {
  FaceModel model = test::block_on_slab();
  auto& sets_of = model.tissue.node_sets;
  for (const BoundaryLabelStyle& label : kBoundaryLabelStyles) sets_of[label.set];
  for (std::size_t n = 0; n < model.tissue.nodes_L.size(); ++n) {
    const Vec3& p = model.tissue.nodes_L[n];
    if (p.x() < 1e-9 && p.z() > 2.0 && p.z() < 5.0)
      sets_of["painted_with_segment"].push_back(std::int32_t(n));
  }
  sets_of[sets::kBonded] = sets_of["painted_with_segment"];
  return model;
}

TEST(FacePreview, OfTissuePaintedToMoveWithTheSegmentIsCloseToThePrediction) {
  const FaceModel model = painted_block();
  const auto& painted = model.tissue.node_sets.at("painted_with_segment");
  ASSERT_GT(painted.size(), 5U);
  const Vec3 by_mm{0.2, 0.3, 0.3};
  EXPECT_LT(distance_mm(model, TissueInterface::kContact, by_mm), 0.08);
  const auto unpainted_mm =
      preview_of(test::block_on_slab()).displacement_mm(std::array{shift(by_mm)}).value();
  // Painted tissue is also pulled; other tissue lifts off.
  for (const double fraction : {1.0, -1.0}) {
    const auto u_mm =
        preview_of(model).displacement_mm(std::array{shift(fraction * by_mm)}).value();
    double max_mm = 0.0;
    for (const std::int32_t node : painted) {
      EXPECT_LT((u_mm[std::size_t(node)] - fraction * by_mm).norm(), 0.05);
      max_mm = std::max(max_mm, unpainted_mm[std::size_t(node)].x());
    }
    EXPECT_LT(max_mm, 0.1);  // Unpainted, it would not follow sideways.
  }
}

TEST(FacePreview, TissueThatTouchesNoSegmentMayBePaintedToMoveWithIt) {
  FaceModel model = painted_block();
  model.tissue.node_sets[sets::kMobilizedSegment].clear();
  const auto u_mm = preview_of(model).displacement_mm(std::array{shift({0.0, 0.5, 0.0})}).value();
  for (const std::int32_t node : model.tissue.node_sets.at("painted_with_segment"))
    EXPECT_NEAR(u_mm[std::size_t(node)].y(), 0.5, 0.05);
}

TEST(FacePreview, OfPushedTissueIsCloseToThePrediction) {
  // Both are compliant: the penalty of the prediction, the supports of the preview.
  EXPECT_LT(distance_mm(test::block_on_slab(), TissueInterface::kContact, {0.0, 0.0, 0.5}), 0.1);
}

TEST(FacePreview, TissueSlidesAndLiftsOff) {
  const FaceModel model = test::block_on_slab();
  const FacePreview preview = preview_of(model);
  const std::array<Vec3, 2> away_mm{Vec3(1.0, 0.0, 0.0), Vec3(0.0, 0.0, -2.0)};
  for (const Vec3& by_mm : away_mm) {
    const auto u_mm = preview.displacement_mm(std::array{shift(by_mm)}).value();
    for (const Vec3& u : u_mm) EXPECT_LT(u.norm(), 1e-9) << by_mm.transpose();
  }
}

TEST(FacePreview, TwiceTheMotionIsTwiceTheDisplacement) {
  const FacePreview preview = preview_of(test::block_on_ball());
  const auto once_mm = preview.displacement_mm(std::array{shift({0.3, 0.1, 1.0})}).value();
  const auto twice_mm = preview.displacement_mm(std::array{shift({0.6, 0.2, 2.0})}).value();
  for (std::size_t v = 0; v < once_mm.size(); ++v)
    EXPECT_LT((twice_mm[v] - 2.0 * once_mm[v]).norm(), 1e-3);
}

/// The reused factor does not change results.
TEST(FacePreview, DoesNotDependOnEarlierCalls) {
  const FaceModel model = test::block_on_ball();
  const FacePreview fresh = preview_of(model), used = preview_of(model);
  for (const double up_mm : {2.0, -1.0, 0.5})
    ASSERT_TRUE(used.displacement_mm(std::array{shift({0.2, 0.0, up_mm})}));
  const auto a_mm = fresh.displacement_mm(std::array{shift({0.0, 0.3, 1.0})}).value();
  const auto b_mm = used.displacement_mm(std::array{shift({0.0, 0.3, 1.0})}).value();
  for (std::size_t v = 0; v < a_mm.size(); ++v) EXPECT_LT((a_mm[v] - b_mm[v]).norm(), 1e-4);
}

TEST(FacePreview, RejectsAModelWithoutSupportsOrFixedNodes) {
  FaceModel untouched = test::block_on_slab();
  untouched.tissue.node_sets[sets::kMobilizedSegment].clear();
  FaceModel loose = test::block_on_slab();
  loose.tissue.node_sets[sets::kFixed].clear();
  for (const FaceModel& model : {untouched, loose}) {
    const auto made = make_preview_model(model, test::surface_of(model), {}, test::paper_boundary(),
                                         Vec3::Ones());
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::kAnatomyMissing);
  }
}

}  // namespace
}  // namespace lefort::predict::test_face_preview
