#include <lefort/inverse/rigid_bodies.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace lefort::inverse::test_rigid_bodies {
namespace {

RigidBody jaw() {
  RigidBody body;
  body.name = "jaw";
  body.segments = {0};
  body.relative = {RigidTransform::Identity()};
  body.center_L = Vec3(120.0, 40.0, 20.0);
  body.start << 0.5, 4.0, -1.0, 2.0, -3.0, 1.0;
  return body;
}

std::string error_of(const RigidBody& body) {
  const auto variables = MotionVariables::create({body}, 1);
  return variables ? "" : variables.error().message;
}

TEST(RigidBodies, NumbersAreInTheAxesOfTheSurgeon) {
  MotionVector anterior = MotionVector::Zero(), vertical = anterior, left = anterior;
  anterior[1] = 3.0;
  vertical[2] = 2.0;
  left[0] = 1.0;
  EXPECT_EQ(keyframe_of(anterior, Vec3::Zero()).translation_mm, Vec3(0.0, -3.0, 0.0));
  EXPECT_EQ(keyframe_of(vertical, Vec3::Zero()).translation_mm, Vec3(0.0, 0.0, 2.0));
  EXPECT_EQ(keyframe_of(left, Vec3::Zero()).translation_mm, Vec3(1.0, 0.0, 0.0));
  // Pitch raises the front, roll the left side; yaw turns the front to the left.
  MotionVector turn = MotionVector::Zero();
  const auto moved = [&](Index number, const Vec3& p_L) {
    turn.setZero();
    turn[number] = 1.0;
    const auto key = keyframe_of(turn, Vec3::Zero());
    return Vec3(geometry::rigid_motion(key.translation_mm, key.rotation_rad, key.center_L) * p_L -
                p_L);
  };
  EXPECT_GT(moved(3, Vec3(0, -100, 0)).z(), 1.0);
  EXPECT_GT(moved(4, Vec3(100, 0, 0)).z(), 1.0);
  EXPECT_GT(moved(5, Vec3(0, -100, 0)).x(), 1.0);
  const RigidBody body = jaw();
  const auto key = keyframe_of(body.start, body.center_L);
  EXPECT_NEAR(-key.rotation_rad.x(), 2.0 * std::acos(-1.0) / 180.0, 1e-15);
  const RigidTransform X_LB =
      geometry::rigid_motion(key.translation_mm, key.rotation_rad, key.center_L);
  EXPECT_LT((motion_of(X_LB, body.center_L) - body.start).norm(), 1e-12);
}

TEST(RigidBodies, RatesAreTheDerivativesOfThePoses) {
  RigidBody body = jaw();
  body.segments = {0, 2};
  RigidTransform relative = geometry::rigid_motion({1, 2, 3}, {0.1, -0.2, 0.05}, {100, 30, 10});
  body.relative.push_back(relative);
  RigidBody other = jaw();
  other.name = "chin";
  other.segments = {1};
  other.is_free = {false, true, false, true, false, false};
  const MotionVariables variables = MotionVariables::create({body, other}, 3).value();
  ASSERT_EQ(variables.count(), 8);
  EXPECT_EQ(variables.name(6), "chin anterior");
  EXPECT_STREQ(variables.unit(6), "mm");
  EXPECT_STREQ(variables.unit(7), "deg");
  const VectorX x = variables.start();
  const std::vector<predict::PoseRate> rates = variables.rates(x);
  const Vec3 p_B(130.0, 10.0, 5.0);
  for (Index n = 0; n < variables.count(); ++n) {
    constexpr double kStep = 1e-5;
    VectorX low = x, high = x;
    low[n] -= kStep;
    high[n] += kStep;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 difference =
          (variables.poses(high)[k] * p_B - variables.poses(low)[k] * p_B) / (2.0 * kStep);
      Vec3 rate = Vec3::Zero();
      for (const auto& [segment, motion] : rates[std::size_t(n)])
        if (segment == k) rate = motion.at(variables.poses(x)[k] * p_B);
      EXPECT_LT((rate - difference).norm(), 1e-8) << n << " " << k;
    }
  }
  // Segments of a body keep their relative pose.
  VectorX moved = x;
  moved.head<6>() << 1, 2, 3, 4, 5, 6;
  const auto poses = variables.poses(moved);
  EXPECT_LT((poses[2].matrix() - (poses[0] * relative).matrix()).norm(), 1e-12);
}

TEST(RigidBodies, TheStartIsMovedIntoTheBounds) {
  RigidBody body = jaw();
  body.upper[1] = 2.5;  // 4 in the plan.
  const MotionVariables variables = MotionVariables::create({body}, 1).value();
  EXPECT_EQ(variables.start()[1], 2.5);
}

TEST(RigidBodies, ImpossibleLimitsAreErrors) {
  RigidBody body = jaw();
  body.lower[2] = 1.0;
  body.upper[2] = -1.0;
  EXPECT_EQ(error_of(body), "body jaw: the bounds of superior contradict each other, 1 > -1");
  body = jaw();
  body.is_free.fill(false);
  EXPECT_EQ(error_of(body), "no number of any movement is free: nothing can be optimized");
  body = jaw();
  body.is_free[1] = false;
  body.upper[1] = 2.0;
  EXPECT_EQ(error_of(body),
            "body jaw: anterior is not free, and its value in the plan, 4, lies outside its bounds "
            "-20 to 2");
  body = jaw();
  body.start[0] = std::nan("");
  EXPECT_EQ(error_of(body), "body jaw: left is not finite");
  EXPECT_EQ(error_of(jaw()), "");
}

}  // namespace
}  // namespace lefort::inverse::test_rigid_bodies
