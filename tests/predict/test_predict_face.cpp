#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/tissue_boundary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "support/box_mesh.h"
#include "support/paper_boundary.h"
#include "support/shapes.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_predict_face {
namespace {

using test::block_on;
using test::block_on_ball;
using test::block_on_slab;
using test::kHeight_mm;
using test::layered_block;
using test::straight;

class PredictFaceWith : public testing::TestWithParam<contact::DetectionMethod> {
 protected:
  [[nodiscard]] static PredictionOptions options() {
    PredictionOptions options = test::paper_options();
    options.contact.detection = GetParam();
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(Both, PredictFaceWith,
                         testing::Values(contact::DetectionMethod::kTrilinear,
                                         contact::DetectionMethod::kSmooth));

TEST_P(PredictFaceWith, PushedTissueFollowsTheBoneExceptForThePenetration) {
  const FaceModel model = block_on_slab();
  const auto prediction = predict_face(model, {straight({0.0, 0.0, 2.0}, 4)}, options()).value();
  ASSERT_TRUE(prediction.converged());
  ASSERT_EQ(prediction.steps.size(), 4U);
  for (const PredictionStep& step : prediction.steps) {
    EXPECT_LE(step.relative_residual, 1e-6);
    EXPECT_GT(step.min_J, 0.0);
    EXPECT_GT(step.contact().normal_force_n, 0.0);
    for (const std::int32_t node : model.tissue.node_sets.at(sets::kFixed))
      EXPECT_EQ(step.displacement_mm[std::size_t(node)], Vec3::Zero());
  }
  const PredictionStep& last = prediction.steps.back();
  EXPECT_GT(last.contact().max_penetration_mm, 0.0);
  EXPECT_LT(last.contact().max_penetration_mm, 0.5);
  for (const std::int32_t node : model.tissue.node_sets.at(sets::kMobilizedSegment)) {
    const double up_mm = last.displacement_mm[std::size_t(node)].z();
    EXPECT_LT(up_mm, 2.0 + 0.1);
    EXPECT_GT(up_mm, 2.0 - 0.6);
  }
}

TEST(PredictFace, OnASlabDetectionMethodsAgree) {
  const FaceModel model = block_on_slab();
  const auto reference =
      predict_face(model, {straight({0.0, 0.0, 1.0}, 2)}, test::paper_options()).value();
  ASSERT_TRUE(reference.converged());
  for (const auto detection :
       {contact::DetectionMethod::kBvh, contact::DetectionMethod::kTrilinear}) {
    PredictionOptions options = test::paper_options();
    options.contact.detection = detection;
    const auto other = predict_face(model, {straight({0.0, 0.0, 1.0}, 2)}, options).value();
    ASSERT_TRUE(other.converged()) << other.failure->message;
    for (std::size_t n = 0; n < model.tissue.nodes_L.size(); ++n)
      EXPECT_LT((reference.steps.back().displacement_mm[n] - other.steps.back().displacement_mm[n])
                    .norm(),
                1e-4);
  }
}

TEST(PredictFace, TheDepthOfHardeningContactIsProportionalToTheTolerance) {
  const FaceModel model = block_on_slab();
  PredictionOptions options = test::paper_options();
  options.solver.relative_tolerance = 1e-8;
  const geometry::RigidPath path = straight({0.0, 0.0, 1.0}, 2);
  const auto p99_mm = [&](std::optional<double> tolerance_mm) {
    options.contact.penetration_tolerance_mm = tolerance_mm;
    const auto prediction = predict_face(model, {path}, options).value();
    EXPECT_TRUE(prediction.converged());
    EXPECT_LE(prediction.steps.back().relative_residual, 1e-8);
    return prediction.steps.back().contact().p99_penetration_increase_mm;
  };
  const double penalty_mm = p99_mm(std::nullopt), coarse_mm = p99_mm(0.04), fine_mm = p99_mm(0.01);
  EXPECT_LT(coarse_mm, penalty_mm);
  EXPECT_LT(fine_mm, 0.02);
  EXPECT_NEAR(fine_mm / coarse_mm, 0.25, 0.1);  // The pressure is nearly the same.
}

TEST(PredictFace, StifferContactLeavesLessPenetration) {
  const FaceModel model = block_on_slab();
  PredictionOptions stiff = test::paper_options();
  stiff.contact.stiffness_factor = 100.0;
  const auto soft =
      predict_face(model, {straight({0.0, 0.0, 1.0}, 2)}, test::paper_options()).value();
  const auto hard = predict_face(model, {straight({0.0, 0.0, 1.0}, 2)}, stiff).value();
  ASSERT_TRUE(soft.converged() && hard.converged());
  EXPECT_LT(hard.steps.back().contact().max_penetration_mm,
            0.3 * soft.steps.back().contact().max_penetration_mm);
}

TEST(PredictFace, StiffnessOfHomogeneousTissueDoesNotMatter) {  // Only ratios matter.
  const FaceModel model = block_on_slab();
  const auto reference =
      predict_face(model, {straight({0.0, 0.0, 1.0}, 2)}, test::paper_options()).value();
  ASSERT_TRUE(reference.converged());
  for (const double factor : {7.0, 1e-9}) {
    PredictionOptions scaled = test::paper_options();
    scaled.tissue.young_mpa *= factor;
    const auto other = predict_face(model, {straight({0.0, 0.0, 1.0}, 2)}, scaled).value();
    ASSERT_TRUE(other.converged()) << "factor " << factor;
    EXPECT_LE(other.steps.back().relative_residual, 1e-6);
    for (std::size_t n = 0; n < model.tissue.nodes_L.size(); ++n)
      EXPECT_LT((reference.steps.back().displacement_mm[n] - other.steps.back().displacement_mm[n])
                    .norm(),
                1e-5)
          << "factor " << factor;
    const double force_n = factor * reference.steps.back().contact().normal_force_n;
    EXPECT_NEAR(other.steps.back().contact().normal_force_n, force_n, 1e-4 * force_n);
  }
}

TEST_P(PredictFaceWith, PressedTissueDoesNotFollowABoneThatSlides) {
  const FaceModel model = block_on_slab();
  geometry::RigidPath path = straight({2.0, 0.0, 1.0}, 4);  // Up, then to the left.
  path.keyframes.insert(path.keyframes.begin(),
                        {.path_fraction = 0.5, .translation_mm = {0.0, 0.0, 1.0}});
  const auto prediction = predict_face(model, {path}, options()).value();
  ASSERT_TRUE(prediction.converged());
  const auto& pressed = prediction.steps[1].displacement_mm;
  const auto& slid = prediction.steps[3].displacement_mm;
  double max_mm = 0.0;
  for (std::size_t n = 0; n < pressed.size(); ++n) {
    EXPECT_LT((slid[n] - pressed[n]).norm(), 2e-3);
    max_mm = std::max(max_mm, pressed[n].norm());
  }
  EXPECT_GT(max_mm, 0.5);
}

TEST_P(PredictFaceWith, ContactOnARotatingRoundBoneBalancesTheReaction) {
  const FaceModel model = block_on_ball();
  geometry::RigidPath path = straight({0.3, 0.0, 1.5}, 4);
  path.keyframes[0].rotation_rad = Vec3(0.15, 0.1, 0.2);
  path.keyframes[0].center_L = Vec3(0.0, 0.0, -10.0);
  const auto prediction = predict_face(model, {path}, options()).value();
  ASSERT_TRUE(prediction.converged());

  const PredictionStep& last = prediction.steps.back();
  const TissueOptions tissue;
  const auto law = fem::NeoHookean::from_young_poisson(tissue.young_mpa, tissue.poisson).value();
  const auto elements = fem::make_element_terms(model.tissue, {{0, law}}).value();
  const fem::Assembler assembler(
      model.tissue.nodes_L,
      fem::DofMap::build(model.tissue.node_count(),
                         fem::prescribe_zero(model.tissue.node_sets.at("fixed")))
          .value(),
      {elements[0].get()});
  VectorX u(3 * model.tissue.node_count());
  for (std::size_t n = 0; n < last.displacement_mm.size(); ++n)
    u.segment<3>(Index(3 * n)) = last.displacement_mm[n];
  const VectorX forces_n = assembler.forces(u)->residual_n;
  Vec3 reaction_n = Vec3::Zero();
  for (const std::int32_t node : model.tissue.node_sets.at(sets::kFixed))
    reaction_n += forces_n.segment<3>(3 * Index(node));
  EXPECT_GT(last.contact().force_L_n.z(), 0.01);
  EXPECT_LT((reaction_n + last.contact().force_L_n).norm(), 1e-4 * last.contact().force_L_n.norm());
}

TEST_P(PredictFaceWith, TissueDoesNotTunnelThroughAThinBone) {
  const FaceModel model = block_on(test::make_box({-4.0, -4.0, -2.0}, {16.0, 16.0, 0.0}));
  const auto prediction = predict_face(model, {straight({0.0, 0.0, 3.0}, 2)}, options()).value();
  ASSERT_TRUE(prediction.converged()) << prediction.failure->message;
  for (const std::int32_t node : model.tissue.node_sets.at(sets::kMobilizedSegment))
    EXPECT_GT(prediction.steps.back().displacement_mm[std::size_t(node)].z(), 3.0 - 0.9);
}

TEST(PredictFace, ARetreatingBoneLeavesTissueWhereItIs) {
  const FaceModel model = block_on_slab();
  const auto prediction =
      predict_face(model, {straight({0.0, 0.0, -2.0}, 2)}, test::paper_options()).value();
  ASSERT_TRUE(prediction.converged());
  for (const Vec3& u : prediction.steps.back().displacement_mm) EXPECT_EQ(u, Vec3::Zero());
}

TEST(PredictFace, BondedTissueMovesExactlyWithTheBone) {
  const FaceModel model = block_on_slab();
  PredictionOptions options = test::paper_options();
  options.boundary.interface = TissueInterface::kBonded;
  geometry::RigidPath path = straight({0.5, 0.0, -1.0}, 3);
  path.keyframes[0].rotation_rad = Vec3(0.0, 0.0, 0.1);
  path.keyframes[0].center_L = Vec3(6.0, 6.0, 0.0);
  const auto prediction = predict_face(model, {path}, options).value();
  ASSERT_TRUE(prediction.converged());
  EXPECT_EQ(prediction.contact_stiffness_mpa_per_mm, 0.0);
  const PredictionStep& last = prediction.steps.back();
  for (const std::int32_t node : model.tissue.node_sets.at(sets::kMobilizedSegment)) {
    const Vec3& X = model.tissue.nodes_L[std::size_t(node)];
    EXPECT_LT((X + last.displacement_mm[std::size_t(node)] - last.segments[0].X_LB * X).norm(),
              1e-12);
  }
}

TEST(PredictFace, SameBitsForAnyNumberOfThreads) {
  const FaceModel model = block_on_slab();
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return predict_face(model, {straight({0.0, 0.3, 1.0}, 2)}, test::paper_options()).value();
  };
  const auto one = with_threads(1), two = with_threads(2);
  ASSERT_TRUE(one.converged() && two.converged());
  EXPECT_EQ(one.steps.back().displacement_mm, two.steps.back().displacement_mm);
}

/// Resumes after each step of the path and expects the same bits.
void expect_same_when_resumed(const FaceModel& model, const geometry::RigidPath& path,
                              PredictionOptions options) {
  options.contact.penetration_tolerance_mm = 0.01;
  std::vector<Restart> kept;
  const PredictionWatch watch{
      .on_step = {}, .on_restart = [&](const Restart& restart) { kept.push_back(restart); }};
  const auto whole = predict_face(model, {path}, options, watch).value();
  ASSERT_TRUE(whole.converged()) << whole.failure->message;
  ASSERT_EQ(kept.size(), std::size_t(path.steps));
  for (const Restart& restart : kept) {
    ASSERT_GT(restart.steps.back().contact().points, 0);
    const auto rest = predict_face(model, {path}, options, {}, Progress::none(), restart).value();
    ASSERT_EQ(rest.steps.size(), whole.steps.size());
    for (std::size_t n = 0; n < whole.steps.size(); ++n) {
      const PredictionStep &a = whole.steps[n], &b = rest.steps[n];
      EXPECT_EQ(a.displacement_mm, b.displacement_mm) << "step " << n;
      EXPECT_EQ(a.contact().force_L_n, b.contact().force_L_n);
      EXPECT_EQ(a.contact().max_penetration_increase_mm, b.contact().max_penetration_increase_mm);
      EXPECT_EQ(a.newton_iterations(), b.newton_iterations());
      EXPECT_EQ(a.residual_n, b.residual_n);
    }
    ASSERT_EQ(rest.nodal_contacts.size(), whole.nodal_contacts.size());
    for (std::size_t k = 0; k < whole.nodal_contacts.size(); ++k)
      for (std::size_t n = 0; n < whole.nodal_contacts[k].size(); ++n) {
        const contact::NodalContact &here = rest.nodal_contacts[k][n],
                                    &there = whole.nodal_contacts[k][n];
        EXPECT_EQ(here.pressure_mpa, there.pressure_mpa) << "node " << n;
        EXPECT_EQ(here.depth_mm, there.depth_mm) << "node " << n;
      }
  }
  double deepest_mm = 0.0;
  for (const auto& of_segment : whole.nodal_contacts)
    for (const contact::NodalContact& node : of_segment)
      deepest_mm = std::max(deepest_mm, node.depth_mm);
  EXPECT_GT(deepest_mm, 0.0);
  EXPECT_LE(deepest_mm, whole.steps.back().contact().max_penetration_increase_mm);
}

TEST(PredictFace, ResumedAfterAnyStepGivesTheSameBits) {
  geometry::RigidPath path = straight({0.8, 0.0, 1.2}, 4);
  path.keyframes[0].rotation_rad = Vec3(0.0, 0.1, 0.1);
  expect_same_when_resumed(block_on_ball(), path, test::paper_options());
}

TEST(PredictFace, ResumedWithASkinLayerGivesTheSameBits) {
  PredictionOptions options = test::paper_options();
  options.tissue.skin = SkinOptions{};
  expect_same_when_resumed(layered_block(), straight({0.2, 0.0, 1.5}, 3), options);
}

TEST(PredictFace, ReportsEachIterationOnceWithoutChangingTheResult) {
  const FaceModel model = block_on_ball();
  PredictionOptions options = test::paper_options();
  options.contact.penetration_tolerance_mm = 0.01;
  const geometry::RigidPath path = straight({0.8, 0.0, 1.2}, 3);
  std::vector<std::vector<PredictionIterate>> reported(1);
  const PredictionWatch watch{
      .on_iterate = [&](const PredictionIterate& at) { reported.back().push_back(at); },
      .on_step = [&](const PredictionStep&) { reported.emplace_back(); },
      .on_restart =
          [&](const Restart& restart) {
            EXPECT_EQ(restart.steps.size(), reported.size());  // Before on_step.
          }};
  const auto seen = predict_face(model, {path}, options, watch).value();
  const auto alone = predict_face(model, {path}, options).value();
  ASSERT_TRUE(seen.converged() && alone.converged());
  EXPECT_EQ(seen.steps.back().displacement_mm, alone.steps.back().displacement_mm);
  ASSERT_EQ(reported.size(), seen.steps.size() + 1);
  EXPECT_TRUE(reported.back().empty());
  for (std::size_t n = 0; n < seen.steps.size(); ++n) {
    std::size_t k = 0;
    int number = 0;
    for (const fem::LoadAttempt& attempt : seen.steps[n].attempts) {
      ++number;
      ASSERT_LE(k + attempt.history.size(), reported[n].size());
      for (std::size_t line = 0; line < attempt.history.size(); ++line, ++k) {
        const PredictionIterate& at = reported[n][k];
        EXPECT_EQ(at.to_fraction, attempt.t_to);
        EXPECT_EQ(at.attempt, number);
        EXPECT_EQ(at.iteration, int(line));
        EXPECT_EQ(at.line.residual_n, attempt.history[line].residual_n);
        EXPECT_EQ(at.line.contacts, attempt.history[line].contacts);
        EXPECT_EQ(at.deepest_mm > 0.0, at.line.contacts > 0);
      }
    }
    EXPECT_EQ(k, reported[n].size());
    // At quadrature points; the statistics are over dense samples.
    const double max_mm = seen.steps[n].contact().max_penetration_increase_mm;
    EXPECT_LE(reported[n].back().deepest_mm, max_mm);
    EXPECT_GT(reported[n].back().deepest_mm, 0.3 * max_mm);
  }
}

TEST(PredictFace, TheFaceDoesNotDependOnTheNumberOfSteps) {
  const FaceModel model = block_on_ball();
  PredictionOptions options = test::paper_options();
  options.solver.relative_tolerance = 1e-8;
  const auto at_end = [&](int steps) {
    return predict_face(model, {straight({1.0, 0.3, 2.0}, steps)}, options).value().steps.back();
  };
  const PredictionStep few = at_end(2), more = at_end(4), many = at_end(8);
  EXPECT_EQ(few.attempts.size(), 2U);  // 2.26 mm by no more than a quarter of 2.5 mm at once.
  EXPECT_EQ(few.displacement_mm, more.displacement_mm);  // By the same increments.
  for (std::size_t n = 0; n < few.displacement_mm.size(); ++n)
    EXPECT_LT((few.displacement_mm[n] - many.displacement_mm[n]).norm(), 1e-5);
}

TEST(PredictFace, RejectsAStepBeyondTheBandOfTheField) {
  const auto refused =
      predict_face(block_on_slab(), {straight({0.0, 0.0, 7.0}, 2)}, test::paper_options());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kStepBeyondBand);
  EXPECT_NE(refused.error().message.find("at least 3 steps"), std::string::npos)
      << refused.error().message;
}

TEST(PredictFace, TheBonePassesThroughEveryKeyframe) {
  geometry::RigidPath detour = straight(Vec3::Zero(), 1);
  detour.keyframes.insert(detour.keyframes.begin(),
                          {.path_fraction = 0.4, .translation_mm = {0.0, 0.0, 2.0}});
  const auto prediction = predict_face(block_on_slab(), {detour}, test::paper_options()).value();
  ASSERT_TRUE(prediction.converged());
  ASSERT_EQ(prediction.steps.size(), 1U);
  const auto& attempts = prediction.steps[0].attempts;
  EXPECT_TRUE(std::any_of(attempts.begin(), attempts.end(), [](const fem::LoadAttempt& attempt) {
    return attempt.t_to == 0.4 && attempt.stop == fem::NewtonStop::kConverged;
  }));
  detour.keyframes[0].translation_mm.z() = 4.0;  // Beyond the band, though it ends where it began.
  EXPECT_EQ(predict_face(block_on_slab(), {detour}, test::paper_options()).error().code,
            ErrorCode::kStepBeyondBand);
}

TEST(PredictFace, SkinHasTheMaterialOfItsRegion) {
  const geometry::RigidPath path = straight({0.0, 0.0, 1.5}, 3);
  PredictionOptions options = test::paper_options();
  const auto whole = predict_face(block_on_slab(), {path}, options).value();
  options.tissue.skin =
      SkinOptions{.young_mpa = options.tissue.young_mpa, .poisson = options.tissue.poisson};
  const auto same = predict_face(layered_block(), {path}, options).value();
  options.tissue.skin->young_mpa *= 20.0;
  const auto stiff = predict_face(layered_block(), {path}, options).value();
  ASSERT_TRUE(whole.converged() && same.converged() && stiff.converged());
  EXPECT_EQ(whole.steps.back().displacement_mm, same.steps.back().displacement_mm);
  // Held at its top and pressed from below, the soft half takes up the deformation of both.
  double middle_mm = 0.0, stiff_middle_mm = 0.0;
  const FaceModel model = layered_block();
  for (std::size_t n = 0; n < model.tissue.nodes_L.size(); ++n) {
    if (model.tissue.nodes_L[n].z() < 0.6 * kHeight_mm) continue;
    middle_mm = std::max(middle_mm, whole.steps.back().displacement_mm[n].norm());
    stiff_middle_mm = std::max(stiff_middle_mm, stiff.steps.back().displacement_mm[n].norm());
  }
  EXPECT_GT(middle_mm, 0.3);
  EXPECT_LT(stiff_middle_mm, 0.3 * middle_mm);
}

TEST(PredictFace, ARegionWithoutAMaterialIsRejected) {
  const auto refused =
      predict_face(layered_block(), {straight({0.0, 0.0, 1.0}, 1)}, test::paper_options());
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
}

TEST(PredictFace, OnlyContactIsLimitedByTheBandOfTheField) {
  const FaceModel model = block_on_slab();
  const geometry::RigidPath far = straight({0.0, 0.0, 7.0}, 2);
  BoundaryOptions boundary = test::paper_boundary();
  const auto smooth = contact::DetectionMethod::kSmooth;
  EXPECT_FALSE(check_query_range({far}, model.segments, smooth, boundary));
  boundary.interface = TissueInterface::kBonded;
  EXPECT_TRUE(check_query_range({far}, model.segments, smooth, boundary));
}

TEST(PredictFace, RejectsAFieldThatDoesNotSufficeForContact) {
  PredictionOptions far_capture = test::paper_options();
  far_capture.boundary.contact_snap_mm = 3.0;
  const auto beyond = predict_face(block_on_slab(), {straight({0.0, 0.0, 1.0}, 1)}, far_capture);
  EXPECT_EQ(beyond.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(beyond.error().message.find("contact_snap_mm is 3 mm"), std::string::npos);

  geometry::TriangleMesh open = test::make_box({-4.0, -4.0, -10.0}, {16.0, 16.0, 0.0});
  open.triangles.pop_back();
  const auto refused =
      predict_face(block_on(open), {straight({0.0, 0.0, 1.0}, 1)}, test::paper_options());
  EXPECT_EQ(refused.error().code, ErrorCode::kMeshInvalid);
}

/// Stores all notes.
class Notes final : public Progress {
 public:
  void note(std::string_view sentence) override { all += sentence; }
  std::string all;
};

TEST(PredictFace, WarnsOfPenetrationAtRest) {
  const geometry::RigidPath path = straight({0.0, 0.0, 0.5}, 1);
  Notes quiet, warned;
  ASSERT_TRUE(predict_face(block_on_slab(), {path}, test::paper_options(), {}, quiet));
  EXPECT_EQ(quiet.all, "");
  const auto deep = predict_face(block_on(test::make_box({-4.0, -4.0, -10.0}, {16.0, 16.0, 1.5})),
                                 {path}, test::paper_options(), {}, warned)
                        .value();
  EXPECT_NEAR(deep.rest_penetration_mm, 1.5, 1e-6);
  EXPECT_NE(warned.all.find("by up to 1.50 mm"), std::string::npos) << warned.all;
}

TEST(PredictFace, RejectsAModelWithoutContactOrFixedNodes) {
  FaceModel untouched = block_on_slab();
  untouched.tissue.node_sets[sets::kMobilizedSegment].clear();
  EXPECT_EQ(
      predict_face(untouched, {straight({0.0, 0.0, 1.0}, 1)}, test::paper_options()).error().code,
      ErrorCode::kAnatomyMissing);
  FaceModel unnamed = block_on_slab();
  unnamed.tissue.face_sets.erase(sets::kContact);
  EXPECT_THROW((void)predict_face(unnamed, {straight({0.0, 0.0, 1.0}, 1)}, test::paper_options()),
               LogicError);
  FaceModel loose = block_on_slab();
  loose.tissue.node_sets[sets::kFixed].clear();
  EXPECT_EQ(predict_face(loose, {straight({0.0, 0.0, 1.0}, 1)}, test::paper_options()).error().code,
            ErrorCode::kAnatomyMissing);
}

TEST(PredictFace, APathThatCannotBeSolvedHasNoSteps) {
  PredictionOptions hurried = test::paper_options();
  hurried.solver.min_increment_ratio = 1.0;
  hurried.solver.max_iterations = 1;
  const auto prediction =
      predict_face(block_on_slab(), {straight({0.0, 0.0, 2.0}, 2)}, hurried).value();
  ASSERT_FALSE(prediction.converged());
  EXPECT_EQ(prediction.failure->code, ErrorCode::kNotConverged);
  EXPECT_TRUE(prediction.steps.empty());
  EXPECT_FALSE(prediction.failed_attempts.empty());
}

/// Requests a stop at once.
class StopAtOnce final : public Progress {
 public:
  [[nodiscard]] bool stop_requested() const override { return true; }
};

TEST(PredictFace, CanBeStopped) {
  StopAtOnce stop;
  const auto stopped = predict_face(block_on_slab(), {straight({0.0, 0.0, 1.0}, 1)},
                                    test::paper_options(), {}, stop);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::predict::test_predict_face
