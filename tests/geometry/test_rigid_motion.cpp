#include <lefort/geometry/motion_rates.h>
#include <lefort/geometry/rigid_motion.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace lefort::geometry::test_rigid_motion {
namespace {

const Vec3 kCenter(3.0, -40.0, 12.0);
const Vec3 kShift(1.0, -6.0, -2.5);

RigidTransform some_pose(const Vec3& rotation_rad) {
  return rigid_motion(kShift, rotation_rad, kCenter);
}

TEST(RigidMotion, MovesTheCenterByTheTranslationForAnyRotation) {
  const RigidTransform X_LB = some_pose({0.2, -0.4, 0.9});
  EXPECT_LT((X_LB * kCenter - (kCenter + kShift)).norm(), 1e-13);
}

TEST(RigidMotion, RotatesCounterClockwiseSeenFromTheTipOfTheAxis) {
  const double quarter = std::numbers::pi / 2.0;
  const RigidTransform X_LB = rigid_motion(Vec3::Zero(), {0.0, 0.0, quarter}, {1.0, 0.0, 0.0});
  EXPECT_LT((X_LB * Vec3(2.0, 0.0, 5.0) - Vec3(1.0, 1.0, 5.0)).norm(), 1e-15);
}

TEST(RigidMotion, KeepsLengthsAndHandedness) {
  const Mat3 R = some_pose({1.1, 0.3, -2.0}).linear();
  EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), 1e-14);
  EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
}

TEST(RigidMotion, WithoutRotationIsExactlyATranslation) {
  const RigidTransform X_LB = some_pose(Vec3::Zero());
  EXPECT_TRUE(X_LB.linear() == Mat3::Identity());
  EXPECT_LT((X_LB.translation() - kShift).norm(), 1e-14);
}

TEST(RotationVector, UndoesTheRotationFromTinyAnglesToNearlyPi) {
  const Vec3 axis = Vec3(1.0, -2.0, 0.5).normalized();
  for (const double angle_rad : {0.0, 1e-12, 1e-7, 0.1, 1.5, 3.0, 3.1415}) {
    const Vec3 found = rotation_vector(some_pose(angle_rad * axis).linear());
    EXPECT_LT((found - angle_rad * axis).norm(), 1e-14 + 1e-12 * angle_rad) << angle_rad;
  }
}

TEST(RotationVector, TakesTheSmallerAngle) {
  const Vec3 found = rotation_vector(some_pose({0.0, 0.0, 1.5 * std::numbers::pi}).linear());
  EXPECT_LT((found - Vec3(0.0, 0.0, -0.5 * std::numbers::pi)).norm(), 1e-14);
}

TEST(InterpolatePose, IsExactAtBothEnds) {
  const RigidTransform from = some_pose({0.1, 0.7, 0.0});
  const RigidTransform to = rigid_motion({4.0, 4.0, 0.0}, {-0.5, 0.0, 1.0}, {9.0, 9.0, 9.0});
  EXPECT_LT((interpolate_pose(from, to, 0.0, kCenter).matrix() - from.matrix()).norm(), 1e-13);
  EXPECT_LT((interpolate_pose(from, to, 1.0, kCenter).matrix() - to.matrix()).norm(), 1e-13);
}

TEST(InterpolatePose, MovesTheCenterStraightAtConstantSpeed) {
  const RigidTransform from = some_pose({0.1, 0.7, 0.0});
  const RigidTransform to = rigid_motion({4.0, 4.0, 0.0}, {-0.5, 0.0, 1.0}, {9.0, 9.0, 9.0});
  for (const double fraction : {0.25, 0.5, 0.8}) {
    const Vec3 expected = (1.0 - fraction) * (from * kCenter) + fraction * (to * kCenter);
    EXPECT_LT((interpolate_pose(from, to, fraction, kCenter) * kCenter - expected).norm(), 1e-13);
  }
}

TEST(InterpolatePose, RotatesAtAConstantRateAboutOneAxis) {
  const Vec3 axis = Vec3(2.0, 1.0, 1.0).normalized();
  const RigidTransform from = some_pose(0.3 * axis);
  const RigidTransform to = some_pose(1.1 * axis);
  const Vec3 half = rotation_vector(interpolate_pose(from, to, 0.5, kCenter).linear());
  EXPECT_LT((half - 0.7 * axis).norm(), 1e-14);
}

TEST(InterpolatePose, DoesNotDependOnTheFrame) {
  const RigidTransform from = some_pose({0.1, 0.7, 0.0});
  const RigidTransform to = some_pose({-0.4, 0.2, 0.6});
  const RigidTransform X_ML = rigid_motion({10.0, 0.0, -3.0}, {0.0, 1.0, 0.4}, Vec3::Zero());
  const RigidTransform in_L = interpolate_pose(from, to, 0.3, kCenter);
  const RigidTransform in_M = interpolate_pose(X_ML * from, X_ML * to, 0.3, kCenter);
  EXPECT_LT((in_M.matrix() - (X_ML * in_L).matrix()).norm(), 1e-13);
}

TEST(MotionRates, AreTheDerivativesOfThePositions) {
  const Vec3 translation(1.0, -2.0, 0.5), center(4.0, 5.0, 6.0), p_B(20.0, -60.0, 15.0);
  // Large, small, tiny and no rotation: both branches of the left Jacobian.
  for (const double size : {2.0, 0.3, 1e-3, 2e-5, 0.0}) {
    const Vec3 rotation = size * Vec3(0.6, -0.48, 0.64);
    const auto rates = motion_rates(translation, rotation, center);
    const Vec3 p_L = rigid_motion(translation, rotation, center) * p_B;
    for (Index i = 0; i < 6; ++i) {
      constexpr double kStep = 1e-6;
      std::array<Vec3, 2> at;
      for (const int side : {0, 1}) {
        Vec3 t = translation, r = rotation;
        (i < 3 ? t[i] : r[i - 3]) += side == 0 ? -kStep : kStep;
        at[std::size_t(side)] = rigid_motion(t, r, center) * p_B;
      }
      EXPECT_LT((rates[std::size_t(i)].at(p_L) - (at[1] - at[0]) / (2.0 * kStep)).norm(), 1e-6)
          << size << ", " << i;
    }
  }
}

TEST(InterpolateScrew, IsExactAtBothEndsAndForAScrewInClosedForm) {
  const RigidTransform from = rigid_motion({1, 2, 3}, {0.3, -0.2, 0.1}, {4, 5, 6});
  const RigidTransform to = rigid_motion({-5, 8, 1}, {-0.8, 0.5, 1.1}, {-2, 0, 7});
  EXPECT_LT((interpolate_screw(from, to, 0.0).matrix() - from.matrix()).norm(), 1e-12);
  EXPECT_LT((interpolate_screw(from, to, 1.0).matrix() - to.matrix()).norm(), 1e-12);
  // A rotation by 90 deg about the line x = 10, y = 0 along z, with 8 mm along it: half of it is 45
  // deg and 4 mm.
  const RigidTransform whole = rigid_motion({0, 0, 8}, {0, 0, std::acos(0.0)}, {10, 0, 0});
  const RigidTransform half = rigid_motion({0, 0, 4}, {0, 0, 0.5 * std::acos(0.0)}, {10, 0, 0});
  EXPECT_LT(
      (interpolate_screw(RigidTransform::Identity(), whole, 0.5).matrix() - half.matrix()).norm(),
      1e-13);
}

TEST(InterpolateScrew, IsTheSameMotionRepeated) {
  const RigidTransform from = rigid_motion({1, 2, 3}, {0.3, -0.2, 0.1}, {4, 5, 6});
  const RigidTransform to = rigid_motion({-5, 8, 1}, {-0.8, 0.5, 1.1}, {-2, 0, 7});
  const RigidTransform step = interpolate_screw(from, to, 0.25) * from.inverse();
  const RigidTransform made = step * step * step * step * from;
  EXPECT_LT((made.matrix() - to.matrix()).norm(), 1e-12);
}

TEST(InterpolateScrew, IsAsExactForATinyRotationAsForNone) {
  const RigidTransform from = RigidTransform::Identity();
  const RigidTransform shift = rigid_motion({0, -6, 1}, Vec3::Zero(), Vec3::Zero());
  const RigidTransform turned = rigid_motion({0, -6, 1}, {1e-9, 0, 0}, Vec3::Zero());
  const Vec3 p(20, -60, 15);
  EXPECT_LT((interpolate_screw(from, shift, 0.5) * p - (p + Vec3(0, -3, 0.5))).norm(), 1e-13);
  EXPECT_LT((interpolate_screw(from, turned, 0.5) * p - (p + Vec3(0, -3, 0.5))).norm(), 1e-7);
}

}  // namespace
}  // namespace lefort::geometry::test_rigid_motion
