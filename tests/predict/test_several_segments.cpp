/// \file
/// Two segments under one block of tissue.
#include <lefort/core/parallel.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/predict/face_preview.h>
#include <lefort/predict/predict_face.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "support/box_mesh.h"
#include "support/paper_boundary.h"
#include "support/shapes.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_several_segments {
namespace {

using test::kHeight_mm;
using test::straight;

constexpr double kLength_mm = 63.0;

/// A long block fixed at its top, like test::block_on(), over slabs; each spans a range of x:
///
///    /////////////////////////  z = 9, fixed
///    |        tissue         |
///    |_______________________|  z = 0
///  | left |            | right |
///
/// Hexahedra, so that the mesh is its own mirror image.
FaceModel long_block(const std::vector<std::pair<double, double>>& slabs_mm) {
  FaceModel model;
  model.tissue = test::box_mesh({.cells = {30, 6, 5},
                                 .size_mm = {kLength_mm, test::kSide_mm, kHeight_mm},
                                 .shape = mesh::ElementShape::kHex8});
  auto& node_sets = model.tissue.node_sets;
  node_sets[sets::kFixed] = node_sets.at("z1");
  model.tissue.face_sets[sets::kContact] = model.tissue.face_sets.at("z0");
  for (const std::int32_t node : node_sets.at("z0")) {
    const double x = model.tissue.nodes_L[std::size_t(node)].x();
    if (std::any_of(slabs_mm.begin(), slabs_mm.end(),
                    [&](const auto& slab) { return slab.first <= x && x <= slab.second; }))
      node_sets[sets::kMobilizedSegment].push_back(node);
  }
  for (const auto& [from_mm, to_mm] : slabs_mm)
    model.segments.push_back(
        test::moved(test::make_box({from_mm, -4.0, -10.0}, {to_mm, 16.0, 0.0})));
  return model;
}

FaceModel two_separate() { return long_block({{-4.0, 8.0}, {55.0, 67.0}}); }
FaceModel two_adjacent() { return long_block({{-4.0, 31.5}, {31.5, 67.0}}); }

geometry::RigidPath named(const std::string& segment, const Vec3& by_mm, int steps = 2) {
  geometry::RigidPath path = straight(by_mm, steps);
  path.segment = segment;
  return path;
}

const Vec3 kStationary = Vec3::Zero();
const Vec3 kUp(0.0, 0.0, 1.5);
const Vec3 kUpAndAside(0.4, 0.2, 0.8);

std::vector<Vec3> face(const FaceModel& model, const std::vector<geometry::RigidPath>& paths,
                       const PredictionOptions& options = test::paper_options()) {
  const auto prediction = predict_face(model, paths, options).value();
  EXPECT_TRUE(prediction.converged()) << prediction.failure->message;
  return prediction.steps.back().displacement_mm;
}

TEST(SeveralSegments, FarFromEachOtherEachMovesItsTissueAsIfAlone) {
  const FaceModel model = two_separate();
  const auto both = face(model, {named("left", kUp), named("right", kUpAndAside)});
  const auto left = face(model, {named("left", kUp), named("right", kStationary)});
  const auto right = face(model, {named("left", kStationary), named("right", kUpAndAside)});
  double moved_mm = 0.0;
  for (std::size_t n = 0; n < both.size(); ++n) {
    const double x = model.tissue.nodes_L[n].x();
    EXPECT_LT((both[n] - left[n] - right[n]).norm(), 0.01) << "x = " << x;
    if (x < 10.0) {
      EXPECT_LT((both[n] - left[n]).norm(), 0.01);
      EXPECT_LT(right[n].norm(), 0.01);
    }
    moved_mm = std::max(moved_mm, both[n].norm());
  }
  EXPECT_GT(moved_mm, 1.0);
  // As without the other slab.
  FaceModel alone = long_block({{-4.0, 8.0}});
  const auto without = face(alone, {named("left", kUp)});
  for (std::size_t n = 0; n < both.size(); ++n) EXPECT_LT((left[n] - without[n]).norm(), 0.01);
}

TEST(SeveralSegments, AMirroredPairGivesAMirroredFace) {
  const FaceModel model = two_separate();
  PredictionOptions options = test::paper_options();
  options.solver.relative_tolerance = 1e-9;
  const auto u =
      face(model, {named("left", {0.3, 0.0, 1.2}), named("right", {-0.3, 0.0, 1.2})}, options);
  const auto& nodes_L = model.tissue.nodes_L;
  int pairs = 0;
  for (std::size_t a = 0; a < u.size(); ++a)
    for (std::size_t b = 0; b < u.size(); ++b) {
      const Vec3 mirrored(kLength_mm - nodes_L[b].x(), nodes_L[b].y(), nodes_L[b].z());
      if ((nodes_L[a] - mirrored).norm() > 1e-9) continue;
      EXPECT_LT((u[a] - Vec3(-u[b].x(), u[b].y(), u[b].z())).norm(), 1e-3)
          << nodes_L[a].transpose();
      ++pairs;
    }
  EXPECT_EQ(pairs, int(u.size()));
}

TEST(SeveralSegments, TwoPiecesThatMoveAsOneActAsOneBone) {
  for (const TissueInterface interface : {TissueInterface::kContact, TissueInterface::kBonded}) {
    PredictionOptions options = test::paper_options();
    options.boundary.interface = interface;
    options.contact.penetration_tolerance_mm = 0.01;
    const auto one = face(long_block({{-4.0, 67.0}}), {named("whole", kUpAndAside)}, options);
    const auto two =
        face(two_adjacent(), {named("left", kUpAndAside), named("right", kUpAndAside)}, options);
    // Each bone has its own field. If tissue along the cut rested on both bones, an edge would drag
    // it by 0.4 mm.
    const double far_mm = interface == TissueInterface::kContact ? 0.1 : 1e-12;
    for (std::size_t n = 0; n < one.size(); ++n) EXPECT_LT((one[n] - two[n]).norm(), far_mm);
  }
}

TEST(SeveralSegments, BondedTissueMovesWithTheClosestSegment) {
  const FaceModel model = two_adjacent();
  PredictionOptions options = test::paper_options();
  options.boundary.interface = TissueInterface::kBonded;
  geometry::RigidPath left = named("left", {-0.3, 0.0, 0.5}),
                      right = named("right", {0.3, 0.0, -0.5});
  right.keyframes[0].rotation_rad = Vec3(0.0, 0.02, 0.0);
  right.keyframes[0].center_L = Vec3(45.0, 6.0, 0.0);
  const auto prediction = predict_face(model, {left, right}, options).value();
  ASSERT_TRUE(prediction.converged());
  const PredictionStep& last = prediction.steps.back();
  for (const std::int32_t node : model.tissue.node_sets.at(sets::kMobilizedSegment)) {
    const Vec3& X = model.tissue.nodes_L[std::size_t(node)];
    const std::size_t k = X.x() <= 31.5 ? 0 : 1;  // On the cut: the first.
    EXPECT_LT((X + last.displacement_mm[std::size_t(node)] - last.segments[k].X_LB * X).norm(),
              1e-12);
  }
}

TEST(SeveralSegments, EachReportsItsContact) {
  const FaceModel model = two_separate();
  const auto prediction = predict_face(model, {named("left", kUp), named("right", {0.0, 0.0, 0.5})},
                                       test::paper_options())
                              .value();
  ASSERT_TRUE(prediction.converged());
  const PredictionStep& last = prediction.steps.back();
  const contact::ContactStatistics &left = last.segments[0].contact,
                                   &right = last.segments[1].contact;
  EXPECT_GT(left.force_L_n.z(), 2.0 * right.force_L_n.z());
  EXPECT_GT(right.force_L_n.z(), 0.0);
  EXPECT_GT(left.max_penetration_increase_mm, right.max_penetration_increase_mm);
  const contact::ContactStatistics both = last.contact();
  EXPECT_EQ(both.nodes, left.nodes + right.nodes);
  EXPECT_EQ(both.force_L_n, left.force_L_n + right.force_L_n);
  EXPECT_EQ(both.max_penetration_increase_mm, left.max_penetration_increase_mm);
  EXPECT_LT(both.mean_penetration_increase_mm, left.mean_penetration_increase_mm);
  EXPECT_GT(both.mean_penetration_increase_mm, right.mean_penetration_increase_mm);
  ASSERT_EQ(prediction.nodal_contacts.size(), 2U);
  for (const contact::NodalContact& node : prediction.nodal_contacts[1]) {
    if (node.pressure_mpa > 0.0) {
      EXPECT_GT(model.tissue.nodes_L[std::size_t(node.node)].x(), 30.0);
    }
  }
}

TEST(SeveralSegments, ThePathWithTheMostStepsSetsAllStepsAndEachPassesItsKeyframes) {
  geometry::RigidPath left = named("left", {0.0, 0.0, 0.4}, 2);
  left.keyframes.insert(left.keyframes.begin(),
                        {.path_fraction = 0.6, .translation_mm = {0.0, 0.0, 0.9}});
  geometry::RigidPath right = named("right", {0.0, 0.0, 0.6}, 4);
  right.keyframes.insert(right.keyframes.begin(),
                         {.path_fraction = 0.3, .translation_mm = {0.0, 0.0, 0.1}});
  const auto prediction =
      predict_face(two_separate(), {left, right}, test::paper_options()).value();
  ASSERT_TRUE(prediction.converged());
  ASSERT_EQ(prediction.steps.size(), 4U);
  for (const PredictionStep& step : prediction.steps) {
    EXPECT_EQ(step.segments[0].X_LB.matrix(), geometry::pose_at(left, step.path_fraction).matrix());
    EXPECT_EQ(step.segments[1].X_LB.matrix(),
              geometry::pose_at(right, step.path_fraction).matrix());
  }
  const auto passes = [&](double path_fraction) {
    for (const PredictionStep& step : prediction.steps)
      for (const fem::LoadAttempt& attempt : step.attempts)
        if (attempt.t_to == path_fraction && attempt.stop == fem::NewtonStop::kConverged)
          return true;
    return false;
  };
  EXPECT_TRUE(passes(0.3));
  EXPECT_TRUE(passes(0.6));
}

TEST(SeveralSegments, SameBitsForAnyNumberOfThreadsAndWhenResumed) {
  const FaceModel model = two_adjacent();
  const std::vector<geometry::RigidPath> paths{named("left", kUp, 3),
                                               named("right", kUpAndAside, 3)};
  PredictionOptions options = test::paper_options();
  options.contact.penetration_tolerance_mm = 1e-2;
  std::vector<Restart> kept;
  const PredictionWatch watch{
      .on_step = {}, .on_restart = [&](const Restart& restart) { kept.push_back(restart); }};
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return predict_face(model, paths, options).value();
  };
  const auto whole = predict_face(model, paths, options, watch).value();
  ASSERT_TRUE(whole.converged()) << whole.failure->message;
  for (const int threads : {1, 3})
    EXPECT_EQ(with_threads(threads).steps.back().displacement_mm,
              whole.steps.back().displacement_mm);
  ASSERT_EQ(kept.size(), 3U);
  for (const Restart& restart : kept) {
    for (const auto& segment : restart.steps.back().segments) EXPECT_GT(segment.contact.points, 0);
    const auto rest = predict_face(model, paths, options, {}, Progress::none(), restart).value();
    ASSERT_EQ(rest.steps.size(), whole.steps.size());
    for (std::size_t n = 0; n < whole.steps.size(); ++n) {
      EXPECT_EQ(rest.steps[n].displacement_mm, whole.steps[n].displacement_mm) << "step " << n;
      for (std::size_t k = 0; k < 2; ++k)
        EXPECT_EQ(rest.steps[n].segments[k].contact.force_L_n,
                  whole.steps[n].segments[k].contact.force_L_n);
    }
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t n = 0; n < whole.nodal_contacts[k].size(); ++n)
        EXPECT_EQ(rest.nodal_contacts[k][n].pressure_mpa, whole.nodal_contacts[k][n].pressure_mpa);
  }
}

TEST(SeveralSegments, ErrorsNameTheSegment) {
  const auto refused = [](const FaceModel& model, const Vec3& right_mm, ErrorCode code,
                          const std::string& text) {
    const auto prediction =
        predict_face(model, {named("left", kUp), named("right", right_mm)}, test::paper_options());
    ASSERT_FALSE(prediction);
    EXPECT_EQ(prediction.error().code, code);
    EXPECT_NE(prediction.error().message.find(text), std::string::npos)
        << prediction.error().message;
  };
  refused(two_separate(), {0.0, 0.0, 7.0}, ErrorCode::kStepBeyondBand, "segment right moves");
  FaceModel bare = two_separate();
  std::erase_if(bare.tissue.node_sets.at(sets::kMobilizedSegment), [&](std::int32_t node) {
    return bare.tissue.nodes_L[std::size_t(node)].x() > 20.0;
  });
  refused(bare, kUp, ErrorCode::kAnatomyMissing, "lies on segment right");
  FaceModel open = two_separate();
  open.segments[1].surface_B.triangles.pop_back();
  open.segments[1] = test::moved(open.segments[1].surface_B);
  refused(open, kUp, ErrorCode::kMeshInvalid, "segment right is an open surface");
}

TEST(SeveralSegments, ThePreviewMovesEach) {
  const FaceModel model = two_separate();
  const geometry::TriangleMesh skin_L = test::surface_of(model);
  const FacePreview preview =
      FacePreview::create(model, {"left", "right"}, skin_L, test::paper_options(), Vec3::Ones())
          .value();
  ASSERT_EQ(preview.segment_count(), 2U);
  const auto shifted = [](const Vec3& by_mm) {
    RigidTransform pose = RigidTransform::Identity();
    pose.translation() = by_mm;
    return pose;
  };
  const Vec3 left_mm(0.0, 0.0, 0.5), right_mm(0.0, 0.0, 0.2);
  const auto both =
      preview.displacement_mm(std::array{shifted(left_mm), shifted(right_mm)}).value();
  const auto full = face(model, {named("left", left_mm), named("right", right_mm)});
  double max_mm = 0.0;
  const double left_end_mm = 6.0,
               right_end_mm = kLength_mm - left_end_mm;  // Away from the edges of the slabs.
  for (const geometry::Triangle& t : skin_L.triangles)
    for (const std::int32_t v : t) {
      const double x = skin_L.vertices[std::size_t(v)].x();
      if (x > left_end_mm && x < right_end_mm) continue;
      EXPECT_LT((both[std::size_t(v)] - full[std::size_t(v)]).norm(), 0.1) << "x = " << x;
      max_mm = std::max(max_mm, full[std::size_t(v)].norm());
    }
  const auto right =
      preview.displacement_mm(std::array{RigidTransform::Identity(), shifted(right_mm)}).value();
  for (std::size_t n = 0; n < right.size(); ++n)
    if (model.tissue.nodes_L[n].x() < 8.0) {
      EXPECT_LT(right[n].norm(), 0.01);
    }
}

}  // namespace
}  // namespace lefort::predict::test_several_segments
