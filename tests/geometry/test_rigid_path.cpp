#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/rigid_path.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

namespace lefort::geometry::test_rigid_path {
namespace {

/// Forward, then down with a rotation about the first molar.
RigidPath two_leg_path() {
  return {.segment = "midface",
          .keyframes = {{.path_fraction = 0.4, .translation_mm = {0.0, -6.0, 0.0}},
                        {.path_fraction = 1.0,
                         .translation_mm = {0.0, -12.0, -5.0},
                         .rotation_rad = {0.2, 0.0, 0.0},
                         .center_L = {0.0, -60.0, -20.0}}},
          .steps = 12};
}

RigidTransform pose_of(const Keyframe& key) {
  return rigid_motion(key.translation_mm, key.rotation_rad, key.center_L);
}

TEST(RigidPath, StartsExactlyAtTheScannedPose) {
  EXPECT_TRUE(pose_at(two_leg_path(), 0.0).matrix() == Eigen::Matrix4d::Identity());
}

TEST(RigidPath, IsExactAtEachKeyframe) {
  const RigidPath path = two_leg_path();
  for (const Keyframe& key : path.keyframes)
    EXPECT_TRUE(pose_at(path, key.path_fraction).matrix() == pose_of(key).matrix());
}

TEST(RigidPath, ATranslationIsProportionalToTheFraction) {
  const Vec3 p_B(3.0, -50.0, 7.0);
  EXPECT_LT((pose_at(two_leg_path(), 0.1) * p_B - (p_B + Vec3(0.0, -1.5, 0.0))).norm(), 1e-13);
}

TEST(RigidPath, MovesTheLaterCenterStraightDuringRotation) {
  const RigidPath path = two_leg_path();
  const Vec3 center_B = path.keyframes[1].center_L;
  const RigidTransform half_way = pose_at(path, 0.7);
  EXPECT_LT((half_way * center_B - (center_B + Vec3(0.0, -9.0, -2.5))).norm(), 1e-13);
  EXPECT_LT((rotation_vector(half_way.linear()) - Vec3(0.1, 0.0, 0.0)).norm(), 1e-14);
}

TEST(RigidPath, IsContinuousAcrossAKeyframe) {
  const RigidPath path = two_leg_path();
  const double before = std::nextafter(0.4, 0.0), after = std::nextafter(0.4, 1.0);
  EXPECT_LT((pose_at(path, before).matrix() - pose_at(path, after).matrix()).norm(), 1e-12);
}

TEST(RigidPath, MaxDisplacementIsThatOfTheFarthestPoint) {
  RigidPath path{.segment = "midface",
                 .keyframes = {{.path_fraction = 1.0, .rotation_rad = {0.0, 0.0, 0.5}}}};
  const std::array<Vec3, 3> points_B{Vec3(1.0, 0.0, 0.0), Vec3(0.0, 8.0, 3.0), Vec3(2.0, 2.0, 0.0)};
  // A chord of the circle of radius 8 over a quarter of the angle.
  EXPECT_NEAR(max_displacement_mm(path, points_B, 0.5, 0.75), 16.0 * std::sin(0.0625), 1e-13);
  EXPECT_EQ(max_displacement_mm(path, {}, 0.0, 1.0), 0.0);
}

TEST(CheckPath, AcceptsAValidPath) { EXPECT_TRUE(check_path(two_leg_path())); }

TEST(CheckPath, RejectsInvalidPathsAndNamesTheValue) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    std::function<void(RigidPath&)> spoil;
    const char* named;
  };
  const std::array<Case, 10> cases{
      {{[](RigidPath& p) { p.keyframes.clear(); }, "`keyframes` is empty"},
       {[](RigidPath& p) { p.steps = 0; }, "`steps` is 0"},
       {[](RigidPath& p) { p.keyframes[0].path_fraction = 0.0; },
        "keyframe 0: `path_fraction` is 0"},
       {[](RigidPath& p) { p.keyframes[1].path_fraction = 1.5; },
        "keyframe 1: `path_fraction` is 1.5"},
       {[](RigidPath& p) { p.keyframes[0].path_fraction = kNan; },
        "keyframe 0: `path_fraction` is nan"},
       {[](RigidPath& p) { p.keyframes[1].path_fraction = 0.4; },
        "keyframe 1: `path_fraction` is 0.4, must be above 0.4"},
       {[](RigidPath& p) { p.keyframes[1].path_fraction = 0.9; }, "last keyframe is at 0.9"},
       {[](RigidPath& p) { p.keyframes[0].translation_mm.y() = kNan; },
        "keyframe 0: its translation"},
       {[](RigidPath& p) { p.keyframes[1].center_L.x() = kNan; }, "keyframe 1: its center"},
       {[](RigidPath& p) { p.keyframes[1].rotation_rad.z() = 3.2; }, "half a turn"}}};
  for (const Case& c : cases) {
    RigidPath path = two_leg_path();
    c.spoil(path);
    const auto checked = check_path(path);
    ASSERT_FALSE(checked) << c.named;
    EXPECT_EQ(checked.error().code, ErrorCode::kPlanInvalid);
    EXPECT_NE(checked.error().message.find("'midface'"), std::string::npos);
    EXPECT_NE(checked.error().message.find(c.named), std::string::npos) << checked.error().message;
  }
}

/// Each keyframe rotates by less than pi, the motion between them by more.
TEST(RigidPath, RejectsARotationByPiBetweenKeyframes) {
  RigidPath path = two_leg_path();
  path.keyframes[0].rotation_rad = {0.0, 0.0, 1.6};
  path.keyframes[1].rotation_rad = {0.0, 0.0, 1.6 - std::numbers::pi};
  const auto refused = check_path(path);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("keyframe 1: half a turn"), std::string::npos)
      << refused.error().message;
  path.keyframes[1].rotation_rad.z() += 0.01;
  EXPECT_TRUE(check_path(path)) << "the other direction is shorter";
}

}  // namespace
}  // namespace lefort::geometry::test_rigid_path
