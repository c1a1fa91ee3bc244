#include <lefort/contact/solve_augmented_lagrangian.h>
#include <lefort/field/build/build_distance_field.h>

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "support/shapes.h"

namespace lefort::contact::test_solve_augmented_lagrangian {
namespace {

constexpr double kStiffness = 0.04;  // MPa/mm
constexpr double kSpring = 0.2;      // N/mm, holds the face down at z = 0.

std::vector<Vec3> face_at(double z) { return {{0.0, 0.0, z}, {0.0, 4.0, z}, {4.0, 0.0, z}}; }

/// A face that rests on bone with its upper face at z = 0; the bone has moved up by 1 mm.
ContactTerm pressed_face(const std::shared_ptr<const field::DistanceField>& bone,
                         std::span<const Vec3> face_L, std::optional<double> tolerance_mm) {
  ContactTerm term(face_L, {{mesh::FaceShape::kTri3, {0, 1, 2}}},
                   {field_distance_query(bone, DetectionMethod::kSmooth).value()},
                   {.stiffness_mpa_per_mm = kStiffness,
                    .contact_snap_mm = 0.1,
                    .penetration_tolerance_mm = tolerance_mm});
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.translation().z() = 1.0;
  term.set_pose(X_LB);
  return term;
}

/// A box below z = 0.
std::shared_ptr<const field::DistanceField> bone(double half_width_mm) {
  return std::make_shared<const field::DistanceField>(
      field::build_distance_field(
          test::make_box({-half_width_mm, -10.0, -8.0}, {half_width_mm, 10.0, 0.0}),
          {.resolution = 64, .band_mm = 3.0, .smooth = true})
          .value());
}

ContactTerm pressed_face(std::optional<double> tolerance_mm) {
  static const auto slab = bone(10.0);
  return pressed_face(slab, face_at(0.0), tolerance_mm);
}

/// \returns the equilibrium of spring and contact, by bisection.
fem::NewtonOutcome find_equilibrium(const ContactTerm& term, const VectorX& start,
                                    std::vector<Vec3> (*at)(double z) = face_at) {
  double low = -0.5, high = 1.5;
  for (int n = 0; n < 60; ++n) {
    const double z = 0.5 * (low + high);
    (kSpring * z < term.summarize(at(z)).force_L_n.z() ? low : high) = z;
  }
  fem::NewtonOutcome outcome;
  outcome.stop = fem::NewtonStop::kConverged;
  outcome.x = VectorX::Zero(9);
  for (int node = 0; node < 3; ++node) outcome.x[3 * node + 2] = low;
  outcome.history = {{.residual_n = start.norm()}, {.residual_n = 0.0}};
  return outcome;
}

TEST(SolveAugmentedLagrangian, WithoutAToleranceThereIsOneSolve) {
  std::vector<ContactTerm> contacts{pressed_face(std::nullopt)};
  int solves = 0;
  const auto outcome = solve_augmented_lagrangian(contacts, face_at(0.0), VectorX::Zero(9),
                                                  [&](const VectorX& start) {
                                                    ++solves;
                                                    return find_equilibrium(contacts[0], start);
                                                  });
  ASSERT_TRUE(outcome.converged());
  EXPECT_EQ(solves, 1);
  // s z = 2 k A (1 - z)
  EXPECT_NEAR(outcome.x[2], 0.64 / (0.64 + kSpring), 1e-6);
}

TEST(SolveAugmentedLagrangian, UpdatesUntilTheToleranceIsReached) {
  std::vector<ContactTerm> contacts{pressed_face(1e-3)};
  int solves = 0;
  const auto outcome = solve_augmented_lagrangian(contacts, face_at(0.0), VectorX::Zero(9),
                                                  [&](const VectorX& start) {
                                                    ++solves;
                                                    return find_equilibrium(contacts[0], start);
                                                  });
  ASSERT_TRUE(outcome.converged());
  // Each update leaves s / (s + 2 k A) of the depth: 0.238^5 is the first below 1e-3.
  EXPECT_EQ(solves, 5);
  EXPECT_EQ(outcome.iterations(), 5);
  const ContactStatistics at_rest = contacts[0].summarize(displaced(face_at(0.0), outcome.x));
  EXPECT_LE(at_rest.p99_penetration_increase_mm, 1e-3);
  EXPECT_NEAR(at_rest.force_L_n.z(), kSpring * 1.0, 2e-4);
}

/// A face across a ridge along y that is narrower than the face.
std::vector<Vec3> across_ridge(double z) {
  return {{-2.0, -1.0, z}, {0.0, 2.5, z}, {2.0, -1.0, z}};
}

TEST(SolveAugmentedLagrangian, AFaceAcrossARidgeIsPushedOffTheTip) {
  std::vector<ContactTerm> contacts{pressed_face(bone(0.75), across_ridge(0.0), 0.05)};
  const auto solve = [&](const VectorX& start) {
    return find_equilibrium(contacts[0], start, across_ridge);
  };
  const auto outcome =
      solve_augmented_lagrangian(contacts, across_ridge(0.0), VectorX::Zero(9), solve);
  ASSERT_TRUE(outcome.converged());
  const ContactStatistics off = contacts[0].summarize(displaced(across_ridge(0.0), outcome.x));
  EXPECT_LE(off.p99_penetration_increase_mm, 0.05);
  EXPECT_EQ(off.tunneled_area_mm2, 0.0);
  EXPECT_NEAR(outcome.x[2], 1.0, 0.05);
}

TEST(SolveAugmentedLagrangian, ReturnsTheLastEquilibriumWhenAFollowingSolveFails) {
  std::vector<ContactTerm> contacts{pressed_face(1e-3)};
  int solves = 0;
  double second_z = 0.0;
  const auto outcome = solve_augmented_lagrangian(
      contacts, face_at(0.0), VectorX::Zero(9), [&](const VectorX& start) {
        fem::NewtonOutcome found = find_equilibrium(contacts[0], start);
        if (++solves == 2) second_z = found.x[2];
        if (solves == 3) found.stop = fem::NewtonStop::kStagnated;
        return found;
      });
  ASSERT_TRUE(outcome.converged());
  EXPECT_EQ(solves, 3);
  EXPECT_EQ(outcome.x[2], second_z);
  EXPECT_EQ(outcome.iterations(), 4);  // The third solve, and the return.
  EXPECT_EQ(outcome.history.back().residual_n, 0.0);
  // In equilibrium with the committed multipliers.
  EXPECT_NEAR(contacts[0].summarize(face_at(second_z)).force_L_n.z(), kSpring * second_z, 1e-9);
  EXPECT_GT(contacts[0].summarize(face_at(second_z)).p99_penetration_increase_mm, 1e-3);
}

TEST(SolveAugmentedLagrangian, ThePenaltyScaleLastsAsLongAsTheMultiplier) {
  ContactTerm term = pressed_face(1e-3);
  const std::vector<Vec3> pressed = face_at(0.0), off = face_at(2.0);
  const auto penalty_scale = [&] { return term.checkpoint().penalty_scales[0]; };
  term.begin_step();
  term.update_multipliers(pressed);
  term.update_multipliers(pressed);  // The depth is the same.
  term.commit(pressed);
  const double stiffer = penalty_scale();
  EXPECT_GT(stiffer, 1.0);
  const double force_n = term.summarize(pressed).force_L_n.z();
  term.begin_step();  // A new increment does not reset it.
  EXPECT_EQ(term.summarize(pressed).force_L_n.z(), force_n);
  ContactTerm resumed = pressed_face(1e-3);
  resumed.restore(term.checkpoint(), pressed);
  EXPECT_EQ(resumed.summarize(pressed).force_L_n.z(), force_n);
  term.update_multipliers(off);
  term.commit(off);
  EXPECT_EQ(penalty_scale(), 1.0);
}

TEST(SolveAugmentedLagrangian, AFirstSolveThatFailsLeavesNoMultipliers) {
  std::vector<ContactTerm> contacts{pressed_face(1e-3)};
  const auto outcome = solve_augmented_lagrangian(
      contacts, face_at(0.0), VectorX::Zero(9), [&](const VectorX& start) {
        fem::NewtonOutcome found = find_equilibrium(contacts[0], start);
        found.stop = fem::NewtonStop::kTooManyIterations;
        return found;
      });
  EXPECT_EQ(outcome.stop, fem::NewtonStop::kTooManyIterations);
  for (const double multiplier_mpa : contacts[0].checkpoint().multipliers_mpa)
    EXPECT_EQ(multiplier_mpa, 0.0);
}

TEST(SolveAugmentedLagrangian, EndsWhereUpdatesReduceNothing) {
  std::vector<ContactTerm> contacts{pressed_face(1e-3)};
  int solves = 0;
  const auto outcome =  // A body that never moves.
      solve_augmented_lagrangian(contacts, face_at(0.0), VectorX::Zero(9),
                                 [&](const VectorX& start) {
                                   ++solves;
                                   fem::NewtonOutcome unchanged;
                                   unchanged.stop = fem::NewtonStop::kConverged;
                                   unchanged.x = start;
                                   unchanged.history = {{}, {}};
                                   return unchanged;
                                 });
  EXPECT_TRUE(outcome.converged());
  EXPECT_EQ(solves, 4);
  EXPECT_NEAR(contacts[0].summarize(face_at(0.0)).p99_penetration_increase_mm, 1.0, 1e-6);
}

}  // namespace
}  // namespace lefort::contact::test_solve_augmented_lagrangian
