#include <lefort/predict/face_preview.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "support/paper_boundary.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_face_preview {
namespace {

FacePreview preview_of(const FaceModel& model,
                       const PredictionOptions& options = test::paper_options()) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < model.segments.size(); ++k) names.push_back("slab");
  return FacePreview::create(model, names, test::surface_of(model), options, Vec3::Ones()).value();
}

RigidTransform shift(const Vec3& by_mm) {
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = by_mm;
  return pose;
}

double max_distance_mm(const std::vector<Vec3>& a_mm, const std::vector<Vec3>& b_mm) {
  double max_mm = 0.0;
  for (std::size_t v = 0; v < a_mm.size(); ++v)
    max_mm = std::max(max_mm, (a_mm[v] - b_mm[v]).norm());
  return max_mm;
}

TEST(FacePreview, NoMotionMovesNothing) {
  const auto u_mm = preview_of(test::block_on_slab())
                        .displacement_mm(std::array{RigidTransform::Identity()})
                        .value();
  for (const Vec3& u : u_mm) EXPECT_EQ(u, Vec3::Zero());
}

/// On the mesh of the prediction, for large motion and with contact.
TEST(FacePreview, IsThePredictionOnTheSameMesh) {
  for (const TissueInterface interface : {TissueInterface::kContact, TissueInterface::kBonded}) {
    const FaceModel model = test::block_on_ball();
    PredictionOptions options = test::paper_options();
    options.boundary.interface = interface;
    const Vec3 by_mm(0.4, 0.2, 1.5);
    const auto prediction = predict_face(model, {test::straight(by_mm, 4)}, options).value();
    ASSERT_TRUE(prediction.converged());
    const auto preview_mm =
        preview_of(model, options).displacement_mm(std::array{shift(by_mm)}).value();
    for (const mesh::Face& face : mesh::boundary_faces(model.tissue))
      for (const std::int32_t node : nodes_of(face))
        EXPECT_LT((preview_mm[std::size_t(node)] -
                   prediction.steps.back().displacement_mm[std::size_t(node)])
                      .norm(),
                  0.01);
  }
}

/// Each call starts from the last equilibrium, with its factor.
TEST(FacePreview, DependsOnEarlierCallsByLessThanItsTolerance) {
  const FaceModel model = test::block_on_ball();
  const FacePreview fresh = preview_of(model), used = preview_of(model);
  for (const double up_mm : {2.0, -1.0, 0.5})
    ASSERT_TRUE(used.displacement_mm(std::array{shift({0.2, 0.0, up_mm})}));
  const auto a_mm = fresh.displacement_mm(std::array{shift({0.0, 0.3, 1.0})}).value();
  const auto b_mm = used.displacement_mm(std::array{shift({0.0, 0.3, 1.0})}).value();
  EXPECT_LT(max_distance_mm(a_mm, b_mm), 0.01);
}

/// During a drag the face follows within two iterations; afterwards the equilibrium is that without
/// a drag.
TEST(FacePreview, FollowsADrag) {
  const FaceModel model = test::block_on_ball();
  const FacePreview preview = preview_of(model), fresh = preview_of(model);
  const auto pose = [](double up_mm) { return std::array{shift({0.0, 0.0, up_mm})}; };
  for (const double up_mm : {0.25, 0.5, 0.75, 1.0}) {
    const Index before = preview.newton_iterations();
    const auto followed_mm = preview.follow_mm(pose(up_mm)).value();
    EXPECT_LE(preview.newton_iterations() - before, 2);
    EXPECT_LT(max_distance_mm(followed_mm, fresh.displacement_mm(pose(up_mm)).value()), 0.1);
  }
  EXPECT_LT(max_distance_mm(preview.displacement_mm(pose(1.0)).value(),
                            fresh.displacement_mm(pose(1.0)).value()),
            0.01);
  RigidTransform bad = RigidTransform::Identity();
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(preview.follow_mm(std::array{bad}));
}

TEST(FacePreview, ASmallMotionTakesFewIterations) {
  const FacePreview preview = preview_of(test::block_on_ball());
  ASSERT_TRUE(preview.displacement_mm(std::array{shift({0.0, 0.0, 1.5})}));
  const Index before = preview.newton_iterations();
  ASSERT_TRUE(preview.displacement_mm(std::array{shift({0.0, 0.0, 1.55})}));
  EXPECT_LE(preview.newton_iterations() - before, 5);
}

TEST(FacePreview, TheMotionOfAVertexHasTheDerivativeOfItsDisplacement) {
  const FaceModel model = test::block_on_ball();
  PredictionOptions options = test::paper_options();
  const FacePreview preview = preview_of(model, options);
  const auto at = [&](const Vec3& by_mm) {
    return preview.displacement_mm(std::array{shift(by_mm)}).value();
  };
  const Vec3 pose_mm(0.0, 0.0, 1.0);
  constexpr double kStep_mm = 0.1;
  const std::vector<Vec3> here = at(pose_mm), plus = at(pose_mm + kStep_mm * Vec3::UnitZ()),
                          minus = at(pose_mm - kStep_mm * Vec3::UnitZ());
  Index vertex = 0;  // The one that moves most.
  for (std::size_t v = 0; v < here.size(); ++v)
    if (here[v].norm() > here[std::size_t(vertex)].norm()) vertex = Index(v);
  const VertexMotion motion = preview.vertex_motion(std::array{shift(pose_mm)}, 0, vertex).value();
  EXPECT_LT((motion.displacement_mm - here[std::size_t(vertex)]).norm(), 0.01);
  for (int axis = 0; axis < 2; ++axis) {
    const Vec3 by_mm = kStep_mm * Vec3::Unit(axis);
    const Vec3 across =
        (at(pose_mm + by_mm)[std::size_t(vertex)] - at(pose_mm - by_mm)[std::size_t(vertex)]) /
        (2 * kStep_mm);
    EXPECT_LT((motion.by_translation.col(axis) - across).norm(), 0.05) << axis;
  }
  const Vec3 difference = (plus[std::size_t(vertex)] - minus[std::size_t(vertex)]) / (2 * kStep_mm);
  EXPECT_GT(difference.norm(), 0.3);
  EXPECT_LT((motion.by_translation.col(2) - difference).norm(), 0.05);
}

TEST(FacePreview, ARejectedPoseKeepsTheLastEquilibrium) {
  const FacePreview preview = preview_of(test::block_on_slab());
  const auto before_mm = preview.displacement_mm(std::array{shift({0.0, 0.0, 0.5})}).value();
  RigidTransform bad = shift({0.0, 0.0, 1.0});
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(preview.displacement_mm(std::array{bad}));
  const auto again_mm = preview.displacement_mm(std::array{shift({0.0, 0.0, 0.5})}).value();
  EXPECT_LT(max_distance_mm(before_mm, again_mm), 0.01);
}

TEST(FacePreview, TheMeshIsCoarse) {
  TissueOptions fine;
  fine.element_order = 2;
  const TissueOptions coarse = preview_tissue(fine);
  EXPECT_GE(coarse.element_size_mm, 6.0);
  EXPECT_GE(coarse.far_element_size_mm, 12.0);
  EXPECT_EQ(coarse.element_order, 1);
  EXPECT_EQ(coarse.young_mpa, fine.young_mpa);
  fine.element_size_mm = 9.0;
  EXPECT_EQ(preview_tissue(fine).element_size_mm, 9.0);
}

TEST(FacePreview, RejectsAModelWithoutSupportsOrFixedNodes) {
  FaceModel untouched = test::block_on_slab();
  untouched.tissue.node_sets[sets::kMobilizedSegment].clear();
  FaceModel loose = test::block_on_slab();
  loose.tissue.node_sets[sets::kFixed].clear();
  for (const FaceModel& model : {untouched, loose}) {
    const auto made = FacePreview::create(model, {"slab"}, test::surface_of(model),
                                          test::paper_options(), Vec3::Ones());
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::kAnatomyMissing);
  }
}

TEST(PreviewDistance, IsOfVerticesThatTheSolutionMoves) {
  const std::vector<Vec3> before(3, Vec3::Zero());
  const std::vector<Vec3> after{Vec3(2, 0, 0), Vec3(1, 0, 0), Vec3(0.4, 0, 0)};
  const PreviewDistance off = measure_preview(
      std::vector<Vec3>{Vec3(1, 0, 0), Vec3(1, 0.5, 0), Vec3(9, 0, 0)}, before, after);
  EXPECT_EQ(off.moved_vertices, 2);
  EXPECT_DOUBLE_EQ(off.max_mm, 1.0);
  EXPECT_DOUBLE_EQ(off.p50_mm, 0.5);
  EXPECT_DOUBLE_EQ(off.max_shift_mm, 2.0);
}

}  // namespace
}  // namespace lefort::predict::test_face_preview
