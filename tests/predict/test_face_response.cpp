#include <lefort/core/parallel.h>
#include <lefort/geometry/motion_rates.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/predict/face_response.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/paper_boundary.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_face_response {
namespace {

using Condition = InterfaceCondition;
using geometry::Keyframe;
using test::kSide_mm;

/// Equilibria to round-off, for central differences.
PredictionOptions exact(PredictionOptions options) {
  options.solver.relative_tolerance = 1e-11;
  return options;
}

PredictionOptions with_interface(TissueInterface interface) {
  PredictionOptions options = exact(test::paper_options());
  options.boundary.interface = interface;
  return options;
}

/// A motion with all six numbers, asymmetric.
const Keyframe kMotion{.translation_mm = Vec3(0.3, -0.2, 0.9),
                       .rotation_rad = Vec3(0.03, -0.05, 0.04),
                       .center_L = Vec3(2.0, 9.0, -3.0)};

RigidTransform pose(const Keyframe& motion) {
  return geometry::rigid_motion(motion.translation_mm, motion.rotation_rad, motion.center_L);
}

std::vector<RigidTransform> poses(const std::vector<Keyframe>& motions) {
  std::vector<RigidTransform> X_LB;
  for (const Keyframe& motion : motions) X_LB.push_back(pose(motion));
  return X_LB;
}

/// The six rates of each segment.
std::vector<PoseRate> all_rates(const std::vector<Keyframe>& motions) {
  std::vector<PoseRate> rates;
  for (std::size_t k = 0; k < motions.size(); ++k)
    for (const geometry::MotionRate& rate : geometry::motion_rates(
             motions[k].translation_mm, motions[k].rotation_rad, motions[k].center_L))
      rates.push_back({{k, rate}});
  return rates;
}

std::unique_ptr<FaceResponse> response_of(const FaceModel& model,
                                          const PredictionOptions& options) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < model.segments.size(); ++k) names.push_back("slab");
  return FaceResponse::create(model, std::move(names), options).value();
}

/// \returns the largest difference of a derivative from the central difference, relative to the
///   largest entry of that derivative.
double error_of_derivatives(const FaceModel& model, const PredictionOptions& options,
                            const std::vector<Keyframe>& motions) {
  const auto response = response_of(model, options);
  const FaceState at = response->solve(poses(motions), response->at_rest()).value();
  const auto rates = all_rates(motions);
  const Eigen::MatrixXd du = response->sensitivities(at, rates).value();
  double error = 0.0;
  for (std::size_t n = 0; n < rates.size(); ++n) {
    const double h = n % 6 < 3 ? 1e-4 : 1e-5;  // mm, rad
    std::array<VectorX, 2> u;
    for (const int side : {0, 1}) {
      std::vector<Keyframe> moved = motions;
      Keyframe& of = moved[n / 6];
      Vec3& vector = n % 6 < 3 ? of.translation_mm : of.rotation_rad;
      vector[Index(n % 3)] += side == 0 ? -h : h;
      u[std::size_t(side)] = response->solve(poses(moved), at).value().at.u;
    }
    const VectorX difference = (u[1] - u[0]) / (2.0 * h);
    const double scale = difference.lpNorm<Eigen::Infinity>();
    EXPECT_GT(scale, 0.01) << n;
    error = std::max(error, (du.col(Index(n)) - difference).lpNorm<Eigen::Infinity>() / scale);
  }
  return error;
}

/// The lower side of the block: bonded, elevated and sliding; one side rests on a foundation that
/// follows half of the motion of the segment, another on a roller.
FaceModel clinical_block() {
  FaceModel model = test::block_on_ball();
  const auto& nodes_L = model.tissue.nodes_L;
  const auto& bottom = model.tissue.node_sets.at("z0");
  for (const std::int32_t node : model.tissue.node_sets.at("boundary")) {
    const Vec3& p = nodes_L[std::size_t(node)];
    NodeInterface one{.node = node};
    if (std::binary_search(bottom.begin(), bottom.end(), node)) {
      one.condition = p.x() < 3.0   ? Condition::kBonded
                      : p.x() < 7.0 ? Condition::kElevated
                                    : Condition::kSliding;
      one.bone = 0;
    } else if (p.z() < test::kHeight_mm && p.x() > kSide_mm - 1e-9) {
      one.condition = Condition::kFoundation;
      model.interface.planes.push_back({.node = node,
                                        .normal_L = Vec3(1.0, 0.2, 0.1).normalized(),
                                        .segment = 0,
                                        .motion_fraction = 0.5});
    } else if (p.z() < test::kHeight_mm && p.y() < 1e-9) {
      one.condition = Condition::kRoller;
      model.interface.planes.push_back({.node = node, .normal_L = -Vec3::UnitY()});
    }
    model.interface.nodes.push_back(one);
  }
  model.tissue.node_sets[sets::kBonded] = {};
  return model;
}

/// Two bones under one block of tissue.
FaceModel on_two_bones() {
  FaceModel model = test::block_on_slab();
  model.segments = {test::moved(test::make_box({-4.0, -4.0, -10.0}, {5.0, 16.0, 0.0})),
                    test::moved(test::make_box({7.0, -4.0, -10.0}, {16.0, 16.0, 0.0}))};
  return model;
}

const Keyframe kOther{.translation_mm = Vec3(-0.1, 0.3, 0.6),
                      .rotation_rad = Vec3(-0.02, 0.03, 0.05),
                      .center_L = Vec3(10.0, 3.0, -2.0)};

TEST(FaceResponse, IsThePredictedFace) {
  for (const TissueInterface interface : {TissueInterface::kBonded, TissueInterface::kContact}) {
    const FaceModel model = test::block_on_ball();
    const PredictionOptions options = with_interface(interface);
    geometry::RigidPath path = test::straight(Vec3::Zero(), 3);
    path.keyframes = {kMotion};
    const FacePrediction prediction = predict_face(model, {path}, options).value();
    const auto response = response_of(model, options);
    const FaceState rest = response->at_rest();
    const FaceState at = response->solve({pose(kMotion)}, rest).value();
    // Another way: through the opposite rotation.
    Keyframe opposite = kMotion;
    opposite.rotation_rad *= -1.0;
    const FaceState aside = response->solve({pose(opposite)}, rest).value();
    const FaceState again = response->solve({pose(kMotion)}, aside).value();
    double moved_mm = 0.0;
    for (std::size_t n = 0; n < model.tissue.nodes_L.size(); ++n) {
      const Vec3& u = prediction.steps.back().displacement_mm[n];
      EXPECT_LT((at.displacement_mm()[n] - u).norm(), 1e-6);
      EXPECT_LT((again.displacement_mm()[n] - u).norm(), 1e-6);
      moved_mm = std::max(moved_mm, u.norm());
    }
    EXPECT_GT(moved_mm, 0.8);
    EXPECT_EQ(at.at.X_LB[0].matrix(), pose(kMotion).matrix());
  }
}

TEST(FaceResponse, DerivativesOfBondedTissueAreCentralDifferences) {
  EXPECT_LT(error_of_derivatives(test::block_on_ball(), with_interface(TissueInterface::kBonded),
                                 {kMotion}),
            1e-6);
}

TEST(FaceResponse, DerivativesOfTissueInContactAreCentralDifferences) {
  EXPECT_LT(error_of_derivatives(test::block_on_ball(), with_interface(TissueInterface::kContact),
                                 {kMotion}),
            1e-5);
}

TEST(FaceResponse, DerivativesWithSupportsAreCentralDifferences) {
  PredictionOptions options = with_interface(TissueInterface::kClinical);
  options.boundary.foundation_mm = 5.0;
  EXPECT_LT(error_of_derivatives(clinical_block(), options, {kMotion}), 1e-5);
}

TEST(FaceResponse, DerivativesByTwoSegmentsAreCentralDifferences) {
  for (const TissueInterface interface : {TissueInterface::kBonded, TissueInterface::kContact})
    EXPECT_LT(error_of_derivatives(on_two_bones(), with_interface(interface), {kMotion, kOther}),
              1e-5)
        << name_of(interface);
}

TEST(FaceResponse, AdjointGivesTheSameGradient) {
  const FaceModel model = on_two_bones();
  const auto response = response_of(model, with_interface(TissueInterface::kContact));
  const std::vector<Keyframe> motions{kMotion, kOther};
  const FaceState at = response->solve(poses(motions), response->at_rest()).value();
  std::vector<PoseRate> rates = all_rates(motions);
  // Both segments as one rigid body.
  rates.push_back({rates[5][0], {1, rates[5][0].second}});
  VectorX dJ_du(at.at.u.size());
  for (Index i = 0; i < dJ_du.size(); ++i) dJ_du[i] = std::sin(0.7 * double(i)) + 0.2;
  const VectorX forward = response->sensitivities(at, rates).value().transpose() * dJ_du;
  const VectorX adjoint = response->gradient(at, dJ_du, rates).value();
  EXPECT_LT((forward - adjoint).norm(), 1e-9 * forward.norm());
  // The derivative is linear in the motion.
  std::vector<PoseRate> second{{{1, rates[5][0].second}}};
  const VectorX other = response->gradient(at, dJ_du, second).value();
  EXPECT_NEAR(adjoint[12], adjoint[5] + other[0], 1e-9 * forward.norm());
}

TEST(FaceResponse, TwoInstancesInTwoThreadsGiveTheBitsOfOne) {
  const FaceModel model = test::block_on_ball();
  const PredictionOptions options = with_interface(TissueInterface::kContact);
  const std::array<Keyframe, 2> motions{kMotion, kOther};
  const auto face = [&](std::size_t which, FaceResponse& response) {
    return response.solve({pose(motions[which])}, response.at_rest()).value().at.u;
  };
  std::array<VectorX, 2> alone, together;
  {
    const ThreadLimit one(1);
    for (const std::size_t k : {0U, 1U}) alone[k] = face(k, *response_of(model, options));
  }
  std::vector<std::thread> threads;
  for (const std::size_t k : {0U, 1U})
    threads.emplace_back([&, k] { together[k] = face(k, *response_of(model, options)); });
  for (std::thread& thread : threads) thread.join();
  for (const std::size_t k : {0U, 1U}) EXPECT_EQ(alone[k], together[k]);
}

TEST(FaceResponse, ErrorsAreReturned) {
  const FaceModel model = test::block_on_slab();
  PredictionOptions options = with_interface(TissueInterface::kContact);
  const auto response = response_of(model, options);
  RigidTransform nan = RigidTransform::Identity();
  nan.translation().x() = std::nan("");
  EXPECT_EQ(response->solve({nan}, response->at_rest()).error().code, ErrorCode::kInvalidArgument);
  // The lower side of the tissue above its fixed upper side.
  const auto bonded = response_of(model, with_interface(TissueInterface::kBonded));
  Keyframe far;
  far.translation_mm = Vec3(0.0, 0.0, 12.0);
  EXPECT_EQ(bonded->solve({pose(far)}, bonded->at_rest()).error().code, ErrorCode::kNotConverged);
  // After a failure the same instance finds the same face.
  const FaceState at = bonded->solve({pose(kMotion)}, bonded->at_rest()).value();
  const auto fresh = response_of(model, with_interface(TissueInterface::kBonded));
  EXPECT_EQ(at.at.u, fresh->solve({pose(kMotion)}, fresh->at_rest()).value().at.u);

  options.contact.detection = contact::DetectionMethod::kBvh;
  const auto by_bvh = response_of(model, options);
  const auto refused = by_bvh->sensitivities(by_bvh->at_rest(), all_rates({kMotion}));
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::predict::test_face_response
