#include <lefort/core/units.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/condylar_axis.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/shapes.h"

namespace lefort::plan::test_condylar_axis {
namespace {

/// Centers (-50, 10, -4) and (48, 12, -2).
const Landmarks kPoles{{"Cdl-R", {-60, 9, -5}},
                       {"Cdm-R", {-40, 11, -3}},
                       {"Cdl-L", {57, 11, -2}},
                       {"Cdm-L", {39, 13, -2}}};

RigidTransform pose_of(const geometry::Keyframe& key, double path_fraction = 1.0) {
  return geometry::pose_at({.segment = "mandible", .keyframes = {key}}, path_fraction);
}

TEST(CondylarAxis, PassesThroughTheMiddlesOfThePoles) {
  const auto axis = condylar_axis(kPoles);
  ASSERT_TRUE(axis) << axis.error().message;
  EXPECT_LT((axis->right_L - Vec3(-50, 10, -4)).norm(), 1e-12);
  EXPECT_LT((axis->left_L - Vec3(48, 12, -2)).norm(), 1e-12);
}

/// About a transverse axis through (y, z) = (10, -4), a chin 80 mm before and 60 mm below it moves
/// on a circle of 100 mm: closing by the angle a raises it and moves it forward.
TEST(CondylarAxis, ClosingMovesTheChinUpAndForwardOnACircle) {
  const CondylarAxis axis{{-50, 10, -4}, {50, 10, -4}};
  for (const double closing_deg : {4.0, -3.0}) {
    const double start = std::atan2(-60.0, 80.0);  // Of (anterior, superior).
    const double angle = start + radians_from_degrees(closing_deg);
    const Vec3 expected(2, 10 - 100 * std::cos(angle), -4 + 100 * std::sin(angle));
    const Vec3 chin = autorotation(axis, closing_deg) * Vec3(2, -70, -64);
    EXPECT_LT((chin - expected).norm(), 1e-12) << closing_deg;
  }
  const Vec3 chin = autorotation(axis, 4.0) * Vec3(0, -70, -64);
  EXPECT_GT(chin.z(), -64.0);
  EXPECT_LT(chin.y(), -70.0);
}

TEST(CondylarAxis, BothCondylesStayInPlaceOnTheWholePath) {
  const CondylarAxis axis = condylar_axis(kPoles).value();
  geometry::Keyframe rest;
  rest.center_L = axis.middle_L();
  const geometry::Keyframe key = after_autorotation(axis, 6.0, rest);
  for (const double fraction : {0.25, 0.5, 1.0}) {
    const RigidTransform X_LB = pose_of(key, fraction);
    EXPECT_LT((X_LB * axis.right_L - axis.right_L).norm(), 1e-12) << fraction;
    EXPECT_LT((X_LB * axis.left_L - axis.left_L).norm(), 1e-12) << fraction;
    // Halfway it has turned by half of the angle.
    EXPECT_LT((X_LB.matrix() - autorotation(axis, 6.0 * fraction).matrix()).norm(), 1e-12);
  }
}

/// The distal segment follows the autorotation, and then moves.
TEST(CondylarAxis, TheKeyframeMovesAfterTheAutorotation) {
  const CondylarAxis axis = condylar_axis(kPoles).value();
  geometry::Keyframe setback;
  setback.path_fraction = 0.5;
  setback.translation_mm = {1, 5, -0.5};
  setback.rotation_rad = {0.02, 0.0, 0.03};
  setback.center_L = {0, -60, -40};
  geometry::Keyframe key = after_autorotation(axis, 3.0, setback);
  EXPECT_EQ(key.path_fraction, 0.5);
  EXPECT_EQ(key.center_L, setback.center_L);
  key.path_fraction = 1.0;
  const RigidTransform X_LB = pose_of(key), closed = autorotation(axis, 3.0);
  // Its center is moved by both, and the rotation does not move it.
  const Vec3 center = closed * setback.center_L;
  EXPECT_LT((X_LB * setback.center_L - (center + setback.translation_mm)).norm(), 1e-12);
  const Vec3 beside = setback.center_L + Vec3(0, 30, 10);
  const Mat3 turn =
      Eigen::AngleAxisd(setback.rotation_rad.norm(), setback.rotation_rad.normalized())
          .toRotationMatrix();
  const Vec3 expected = turn * (closed * beside - center) + center + setback.translation_mm;
  EXPECT_LT((X_LB * beside - expected).norm(), 1e-12);
}

TEST(CondylarAxis, MissingOrExchangedPolesAreNamed) {
  Landmarks three = kPoles;
  three.pop_back();
  EXPECT_NE(condylar_axis(three).error().message.find("Cdm-L"), std::string::npos);
  Landmarks exchanged = kPoles;
  for (Landmark& one : exchanged) one.point_L.x() *= -1.0;
  ASSERT_FALSE(condylar_axis(exchanged));
  EXPECT_EQ(condylar_axis(exchanged).error().code, ErrorCode::kPlanInvalid);
  Landmarks close = kPoles;
  for (Landmark& one : close) one.point_L *= 0.4;
  EXPECT_NE(condylar_axis(close).error().message.find("mm apart"), std::string::npos);
}

/// Upper teeth end at z = -30; a lower tooth 80 mm before and 40 mm below the axis closes until it
/// is 2 mm below them: asin((26 + 2) / r) below the horizontal instead of asin(40 / r).
TEST(CondylarAxis, TheTeethCloseToAGap) {
  const CondylarAxis axis{{-50, 10, -4}, {50, 10, -4}};
  std::vector<UpperBone> upper{{geometry::Bvh(test::make_box({-30, -120, -30}, {30, -40, -10}))}};
  const std::vector<Vec3> lower{{0, -70, -44}, {5, -60, -46}};
  const double r = std::hypot(80.0, 40.0);
  const auto angle_of = [&](double z_mm) {
    return degrees_from_radians(std::asin(40.0 / r) - std::asin((-4.0 - z_mm) / r));
  };
  const auto closing = closing_to_gap(axis, lower, upper, 2.0);
  ASSERT_TRUE(closing) << closing.error().message;
  EXPECT_NEAR(*closing, angle_of(-32.0), 2e-3);
  RigidTransform& impacted = upper[0].X_LB;
  impacted.translation() = Vec3(0, -2, 3);
  EXPECT_NEAR(closing_to_gap(axis, lower, upper, 2.0).value(), angle_of(-29.0), 2e-3);
  impacted.translation() = Vec3(0, 0, 60);
  EXPECT_NE(closing_to_gap(axis, lower, upper, 2.0).error().message.find("do not meet"),
            std::string::npos);
  impacted.translation() = Vec3(0, 0, -60);
  EXPECT_NE(closing_to_gap(axis, lower, upper, 2.0).error().message.find("do not separate"),
            std::string::npos);
}

/// The gap is that after the motion that follows: if the tooth then moves down by 3 mm, it closes
/// until it is 3 mm nearer. Of two upper bones the lower one decides.
TEST(CondylarAxis, TheGapIsThatAtTheEndOfTheKeyframe) {
  const CondylarAxis axis{{-50, 10, -4}, {50, 10, -4}};
  std::vector<UpperBone> upper{{geometry::Bvh(test::make_box({-30, -120, -30}, {0, -40, -10}))},
                               {geometry::Bvh(test::make_box({1, -120, -30}, {30, -40, -10}))}};
  const std::vector<Vec3> lower{{-20, -70, -44}, {20, -70, -44}};
  const double r = std::hypot(80.0, 40.0);
  const auto angle_of = [&](double z_mm) {
    return degrees_from_radians(std::asin(40.0 / r) - std::asin((-4.0 - z_mm) / r));
  };
  geometry::Keyframe then;
  then.translation_mm = {0, 5, -3};
  for (const double impaction_mm : {0.0, 2.0, 4.0, -1.0, -3.0}) {
    upper[0].X_LB.translation() = Vec3(0, -5, impaction_mm);
    upper[1].X_LB.translation() = Vec3(0, -5, 0);
    const double lowest_mm = -30.0 + std::min(impaction_mm, 0.0);
    EXPECT_NEAR(closing_to_gap(axis, lower, upper, 0.5, then).value(),
                angle_of(lowest_mm - 0.5 + 3.0), 2e-3)
        << impaction_mm;
  }
}

TEST(CondylarAxis, LowerTeethLieAboveAPlaneThroughTheirLandmarks) {
  const geometry::TriangleMesh mandible = test::make_box({-40, -80, -90}, {40, 0, -40});
  Landmarks teeth{{"L1", {0, -80, -40}}, {"L6-R", {-25, -50, -42}}, {"L6-L", {25, -50, -42}}};
  const auto points = points_of_lower_teeth(mandible, teeth);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->size(), 2U);  // The anterior corners above.
  for (const Vec3& p : *points) EXPECT_EQ(Vec3(0, p.y(), p.z()), Vec3(0, -80, -40));
  teeth.pop_back();
  EXPECT_NE(points_of_lower_teeth(mandible, teeth).error().message.find("L6-L"), std::string::npos);
}

}  // namespace
}  // namespace lefort::plan::test_condylar_axis
