#include <lefort/core/parallel.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/inverse/optimize_motion.h>
#include <lefort/predict/path_overlaps.h>

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/paper_boundary.h"
#include "support/stop_at_once.h"
#include "support/tissue_block.h"

namespace lefort::inverse::test_optimize_motion {
namespace {

/// A model that lives as long as this.
struct Model {
  predict::FaceModel face;
  std::unique_ptr<predict::FaceResponse> response;
  LiveFace live;
};

/// The block on a slab or ball; its whole surface is the skin.
///
/// \param poisson  differs between the coarse and the fine model.
std::unique_ptr<Model> block(predict::TissueInterface interface, double poisson) {
  auto model = std::make_unique<Model>();
  model->face = test::block_on_ball();
  predict::PredictionOptions options = test::paper_options();
  options.boundary.interface = interface;
  options.tissue.poisson = poisson;
  options.solver.relative_tolerance = 1e-10;
  model->response = predict::FaceResponse::create(model->face, {"slab"}, options).value();
  model->live = {model->response.get(),
                 predict::embed_skin(test::surface_of(model->face), model->face.tissue, 1.0)};
  return model;
}

RigidBody body() {
  RigidBody one;
  one.name = "slab";
  one.segments = {0};
  one.relative = {RigidTransform::Identity()};
  one.center_L = Vec3(6.0, 6.0, -6.0);
  one.lower = MotionVector::Constant(-3.0);
  one.upper = MotionVector::Constant(3.0);
  return one;
}

const std::vector<Vec3> kPoints{{0, 6, 2},  {12, 6, 3}, {6, 0, 2}, {6, 12, 4},
                                {0, 12, 3}, {12, 0, 2}, {0, 0, 5}};

/// Landmarks at kPoints of the block that should have these displacements.
FaceTarget landmarks_at(const std::vector<Vec3>& displacement_mm) {
  FaceTarget target;
  for (std::size_t n = 0; n < kPoints.size(); ++n)
    target.landmarks.push_back({.name = "P" + std::to_string(n),
                                .point_L = kPoints[n],
                                .to_L = kPoints[n] + displacement_mm[n]});
  return target;
}

FaceObserver observer_of(const Model& model, FaceTarget target) {
  geometry::TriangleMesh skin = test::surface_of(model.face);
  const std::vector<char> moved(skin.vertices.size(), 1);
  return FaceObserver::create(std::move(skin), moved, std::move(target)).value();
}

/// A segment of the same shape, and a wall at y = 24 that it must not enter.
struct Bones {
  geometry::TriangleMesh segment = test::make_box({-4.0, -4.0, -10.0}, {16.0, 22.0, -4.0});
  geometry::TriangleMesh wall = test::make_box({-20.0, 23.0, -20.0}, {30.0, 30.0, 10.0});

  [[nodiscard]] BoneClearance clearance(double allowed_mm) const {
    std::vector<predict::MovingBone> bones;
    for (const auto& [name, surface] :
         {std::pair{"slab", &segment}, std::pair{predict::kRemainder, &wall}})
      bones.push_back(
          predict::make_moving_bone(name, *surface, nullptr, test::moved(*surface).field_B)
              .value());
    return {std::move(bones), allowed_mm};
  }
};

/// The same numbers with every standard library.
class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  [[nodiscard]] double uniform(double low, double high) {
    return low + (high - low) * double(generator_()) / 4294967296.0;
  }

 private:
  std::mt19937 generator_;
};

VectorX random_in(const MotionVariables& variables, Random& random) {
  VectorX x(variables.count());
  for (Index n = 0; n < x.size(); ++n)
    x[n] = random.uniform(variables.lower()[n], variables.upper()[n]);
  return x;
}

/// Where the landmarks are after the motion x.
std::vector<Vec3> reached(Model& model, const MotionVariables& variables, const VectorX& x) {
  const auto state = model.response->solve(variables.poses(x), model.response->at_rest()).value();
  const FaceObserver observer =
      observer_of(model, landmarks_at(std::vector<Vec3>(7, Vec3::Zero())));
  std::vector<Vec3> u;
  for (const Observation& one :
       observer.observe(predict::skin_displacement(model.live.embedding, state.displacement_mm())))
    if (u.size() < 7 && (u.empty() || one.at_L != u.back())) u.push_back(one.at_L);
  for (std::size_t n = 0; n < u.size(); ++n) u[n] -= kPoints[n];
  return u;
}

TEST(OptimizeMotion, RecoversAMovementFromTheFaceOfAnotherModel) {
  const auto coarse = block(predict::TissueInterface::kBonded, 0.30);
  const auto fine = block(predict::TissueInterface::kBonded, 0.45);
  const MotionVariables variables = MotionVariables::create({body()}, 1).value();
  VectorX truth(6);
  truth << 0.3, -0.4, 0.8, 1.5, -2.0, 1.0;
  const FaceObserver observer = observer_of(*fine, landmarks_at(reached(*fine, variables, truth)));
  const Bones bones;
  const BoneClearance clearance = bones.clearance(0.5);
  const MotionProblem problem{observer, variables, clearance};
  Random random(5);
  for (int start = 0; start < 3; ++start) {
    const MotionResult found =
        optimize_motion(coarse->live, &fine->live, problem, 0.4 * random_in(variables, random), {},
                        {}, Progress::none())
            .value();
    EXPECT_TRUE(found.converged);
    EXPECT_LT((found.face.x - truth).lpNorm<Eigen::Infinity>(), 0.05) << found.face.x.transpose();
    EXPECT_LT(*found.gradient_error, 1e-4);
    // Without the correction the coarse model finds another movement.
    EXPECT_GT((found.corrections[0].x - truth).lpNorm<Eigen::Infinity>(), 0.06);
    EXPECT_LT(found.corrections.back().fine_objective, 1e-4);
    EXPECT_EQ(found.directions.size(), 6U);
  }
}

TEST(OptimizeMotion, LimitsHoldForAnyTarget) {
  const auto coarse = block(predict::TissueInterface::kBonded, 0.45);
  RigidBody limited = body();
  limited.lower << -0.5, -2.0, -0.3, -1.0, -1.0, 0.0;
  limited.upper << 0.5, 0.7, 0.4, 1.0, 1.0, 0.0;
  const MotionVariables variables = MotionVariables::create({limited}, 1).value();
  ASSERT_EQ(variables.count(), 5);  // yaw cannot change.
  const Bones bones;
  const BoneClearance clearance = bones.clearance(0.2);
  MotionOptions options;
  options.check_step = 0.0;
  options.coarse.max_iterations = 12;
  Random random(11);
  int at_bound = 0, by_overlap = 0;
  for (int n = 0; n < 12; ++n) {
    std::vector<Vec3> wanted;
    for (std::size_t p = 0; p < kPoints.size(); ++p)
      wanted.push_back(
          Vec3(random.uniform(-3.0, 3.0), random.uniform(-1.0, 5.0), random.uniform(-2.0, 2.0)));
    const FaceObserver observer = observer_of(*coarse, landmarks_at(wanted));
    const MotionProblem problem{observer, variables, clearance};
    const MotionResult found = optimize_motion(coarse->live, nullptr, problem, variables.start(),
                                               options, {}, Progress::none())
                                   .value();
    EXPECT_TRUE((found.face.x.array() >= variables.lower().array()).all());
    EXPECT_TRUE((found.face.x.array() <= variables.upper().array()).all());
    EXPECT_LE(clearance.deepest(variables.poses(found.face.x)).depth_mm, 0.2);
    for (Index i = 0; i < 5; ++i)
      at_bound += found.at_lower[std::size_t(i)] + found.at_upper[std::size_t(i)];
    by_overlap += found.is_limited_by_overlap ? 1 : 0;
  }
  EXPECT_GT(at_bound, 0);  // The limits matter.
  EXPECT_GT(by_overlap, 0);
}

TEST(OptimizeMotion, NamesTheMovementThatATargetDoesNotDetermine) {
  const auto coarse = block(predict::TissueInterface::kBonded, 0.45);
  const MotionVariables variables = MotionVariables::create({body()}, 1).value();
  FaceTarget one;
  one.landmarks = {{.name = "P",
                    .point_L = kPoints[0],
                    .to_L = kPoints[0] + Vec3(0.0, 0.0, 0.4),
                    .direction_L = Vec3::UnitZ()}};
  const FaceObserver observer = observer_of(*coarse, one);
  const Bones bones;
  const BoneClearance clearance = bones.clearance(0.5);
  MotionOptions options;
  options.check_step = 0.0;
  const MotionResult found =
      optimize_motion(coarse->live, nullptr, {observer, variables, clearance}, variables.start(),
                      options, {}, Progress::none())
          .value();
  EXPECT_LT(found.face.objective, 1e-4);
  EXPECT_TRUE(found.directions[0].is_determined);
  for (std::size_t n = 1; n < 6; ++n) EXPECT_FALSE(found.directions[n].is_determined) << n;
}

TEST(OptimizeMotion, OverlapWithoutAnyFeasibleMovementIsAnError) {
  const auto coarse = block(predict::TissueInterface::kBonded, 0.45);
  const MotionVariables variables = MotionVariables::create({body()}, 1).value();
  Bones bones;
  for (Vec3& v : bones.wall.vertices) v.y() -= 6.0;
  const FaceObserver observer =
      observer_of(*coarse, landmarks_at(std::vector<Vec3>(7, kPoints[0] * 0.0)));
  const BoneClearance clearance = bones.clearance(0.5);
  const auto found = optimize_motion(coarse->live, nullptr, {observer, variables, clearance},
                                     variables.start(), {}, {}, Progress::none());
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(found.error().message.find("slab and remainder overlap by"), std::string::npos)
      << found.error().message;
}

TEST(OptimizeMotion, BitsDoNotDependOnTheNumberOfThreads) {
  const MotionVariables variables = MotionVariables::create({body()}, 1).value();
  const Bones bones;
  const BoneClearance clearance = bones.clearance(0.5);
  std::vector<VectorX> x;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const auto coarse = block(predict::TissueInterface::kContact, 0.45);
    const FaceObserver observer =
        observer_of(*coarse, landmarks_at(std::vector<Vec3>(7, Vec3(0.1, -0.2, 0.5))));
    MotionOptions options;
    options.check_step = 0.0;
    options.coarse.max_iterations = 4;
    x.push_back(optimize_motion(coarse->live, nullptr, {observer, variables, clearance},
                                variables.start(), options, {}, Progress::none())
                    .value()
                    .face.x);
  }
  EXPECT_EQ(x[0], x[1]);
}

TEST(BoneClearance, AnOverlapBeyondTheRangeOfTheFieldIsNeverWithinTheLimit) {
  const Bones bones;
  const auto at = [&](double y_mm, double allowed_mm) {
    const BoneClearance clearance = bones.clearance(allowed_mm);
    RigidTransform X_LB = RigidTransform::Identity();
    X_LB.translation() = Vec3(0, y_mm, 0);
    const std::vector<RigidTransform> poses{X_LB};
    const DeepestOverlap overlap = clearance.deepest(poses);
    return std::pair{overlap.is_lower_bound, clearance.is_within(overlap)};
  };
  EXPECT_EQ(at(0.5, 0.2), std::pair(false, true));
  EXPECT_EQ(at(1.5, 0.2), std::pair(false, false));  // 0.5 mm deep.
  EXPECT_EQ(at(1.5, 0.6), std::pair(false, true));
  EXPECT_EQ(at(4.5, 100.0), std::pair(true, false));  // 3.5 mm, at the middle of 7 mm.
}

}  // namespace
}  // namespace lefort::inverse::test_optimize_motion
