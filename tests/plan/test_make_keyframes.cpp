#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/make_keyframes.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::plan::test_make_keyframes {
namespace {

const Landmarks kMaxilla{
    {"ANS", {0, -40, 20}}, {"PNS", {0, 5, 18}}, {"A", {1, -38, 14}}, {"U6-R", {-25, -15, 2}}};

TEST(MakeKeyframes, KeyframeHasTheGivenPose) {
  const RigidTransform X = geometry::rigid_motion({1, -6, 2}, {0.1, 0.2, -0.3}, {10, 20, 30});
  const geometry::Keyframe key = keyframe_of_pose(X, {5, 6, 7});
  const geometry::RigidPath path{.segment = "s", .keyframes = {key}};
  EXPECT_LT((geometry::pose_at(path, 1.0).matrix() - X.matrix()).norm(), 1e-12);
  EXPECT_EQ(key.center_L, Vec3(5, 6, 7));
}

TEST(MakeKeyframes, LandmarksReachTheirTargets) {
  const RigidTransform X = geometry::rigid_motion({0.5, -5, 1}, {0.05, 0.0, 0.02}, {0, 0, 0});
  Landmarks targets;
  for (const Landmark& landmark : kMaxilla)
    targets.push_back({landmark.name, X * landmark.point_L});
  targets.erase(targets.begin());
  const auto key = keyframe_to_targets(kMaxilla, targets, 0.5);
  ASSERT_TRUE(key) << key.error().message;
  const geometry::RigidPath path{.segment = "s", .keyframes = {*key}};
  EXPECT_LT((geometry::pose_at(path, 1.0).matrix() - X.matrix()).norm(), 1e-10);
}

TEST(MakeKeyframes, RejectsTargetsWithoutRigidMotionByName) {
  Landmarks targets = kMaxilla;
  targets[3].point_L.x() -= 8.0;
  const auto key = keyframe_to_targets(kMaxilla, targets, 1.0);
  ASSERT_FALSE(key);
  EXPECT_EQ(key.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(key.error().message.find("would miss"), std::string::npos) << key.error().message;
  EXPECT_TRUE(keyframe_to_targets(kMaxilla, targets, 10.0));
  targets[3].name = "U6-L";
  EXPECT_NE(keyframe_to_targets(kMaxilla, targets, 10.0).error().message.find("U6-L"),
            std::string::npos);
  targets.resize(2);
  EXPECT_NE(keyframe_to_targets(kMaxilla, targets, 10.0).error().message.find("2 points"),
            std::string::npos);
}

/// Three points lie in a plane, and a rotation by 180 degrees maps them to their mirror image.
TEST(MakeKeyframes, RejectsTargetsWithExchangedSides) {
  const Landmarks maxilla{{"ANS", {0, -40, 20}}, {"U6-R", {-25, -15, 2}}, {"U6-L", {26, -15, 2}}};
  Landmarks targets = maxilla;
  for (Landmark& target : targets) target.point_L.y() -= 5.0;
  ASSERT_TRUE(keyframe_to_targets(maxilla, targets, 1.0));
  std::swap(targets[1].point_L, targets[2].point_L);
  const auto key = keyframe_to_targets(maxilla, targets, 1.0);
  ASSERT_FALSE(key);
  EXPECT_EQ(key.error().code, ErrorCode::kPlanInvalid);
  EXPECT_EQ(key.error().message,
            "the targets of ANS, U6-R, U6-L rotate the segment by 180 degrees, at most 45 are "
            "allowed: are -R and -L exchanged?");
}

TEST(MakeKeyframes, PerfectFitPassesZeroTolerance) {
  EXPECT_TRUE(keyframe_to_targets(kMaxilla, kMaxilla, 0.0));
  EXPECT_FALSE(keyframe_to_targets(kMaxilla, kMaxilla, std::nan("")));
}

TEST(MakeKeyframes, DistractionIsProportionalToDays) {
  const std::vector<DistractionPhase> phases{{{0, -2, 0}, 1.0, 6}, {{0, 0, -1}, 0.5, 4}};
  const auto keys = distraction_keyframes(phases);
  ASSERT_TRUE(keys);
  ASSERT_EQ(keys->size(), 2U);
  EXPECT_EQ((*keys)[0].path_fraction, 0.6);
  EXPECT_EQ((*keys)[1].path_fraction, 1.0);
  EXPECT_EQ(total_days(phases), 10);
  const geometry::RigidPath path{.segment = "s", .keyframes = *keys, .steps = 10};
  ASSERT_TRUE(geometry::check_path(path));
  EXPECT_LT((geometry::pose_at(path, 0.1).translation() - Vec3(0, -1, 0)).norm(),
            1e-12);  // After a day.
  EXPECT_LT((geometry::pose_at(path, 1.0).translation() - Vec3(0, -6, -2)).norm(), 1e-12);
}

TEST(MakeKeyframes, RejectsInvalidDistraction) {
  for (const auto& [phases, words] :
       std::vector<std::pair<std::vector<DistractionPhase>, const char*>>{
           {{}, "is empty"},
           {{{{0, 0, 0}, 1.0, 3}}, "phase 0: its direction"},
           {{{{0, 1, 0}, -1.0, 3}}, "-1 mm a day"},
           {{{{0, 1, 0}, 1.0, 0}}, "0 days"},
           {{{{0, 1, 0}, 1.0, 600}, {{0, 1, 0}, 1.0, 600}}, "phase 1: 600 days"},
           {{{{0, 1, 0}, 1.0, 2000000000}, {{0, 1, 0}, 1.0, 2000000000}}, "phase 0: 2000000000"}}) {
    const auto keys = distraction_keyframes(phases);
    ASSERT_FALSE(keys) << words;
    EXPECT_EQ(keys.error().code, ErrorCode::kPlanInvalid);
    EXPECT_NE(keys.error().message.find(words), std::string::npos) << keys.error().message;
  }
}

TEST(MakeKeyframes, ScrewMotionRotatesAboutOneFixedAxis) {
  geometry::Keyframe key;
  key.rotation_rad = {0, 0, 1.0};
  key.center_L = {10, 0, 0};
  key.translation_mm = {0, 0, 6};
  geometry::RigidPath path{
      .segment = "s", .keyframes = {key}, .interpolation = geometry::Interpolation::kScrew};
  const Vec3 on_axis_B(10, 0, 3), half_way = geometry::pose_at(path, 0.5) * on_axis_B;
  EXPECT_LT((half_way - Vec3(10, 0, 6)).norm(), 1e-12);
  // With another center, the path to the same end pose differs, except for a screw motion.
  const geometry::Keyframe same = keyframe_of_pose(geometry::pose_at(path, 1.0), {-50, 0, 0});
  geometry::RigidPath other{
      .segment = "s", .keyframes = {same}, .interpolation = geometry::Interpolation::kScrew};
  EXPECT_LT((geometry::pose_at(other, 0.5).matrix() - geometry::pose_at(path, 0.5).matrix()).norm(),
            1e-12);
  other.interpolation = geometry::Interpolation::kStraight;
  EXPECT_GT((geometry::pose_at(other, 0.5).matrix() - geometry::pose_at(path, 0.5).matrix()).norm(),
            1.0);
}

}  // namespace
}  // namespace lefort::plan::test_make_keyframes
