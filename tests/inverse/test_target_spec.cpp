#include <lefort/inverse/target_spec.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/shapes.h"

namespace lefort::inverse::test_target_spec {
namespace {

const plan::Landmarks kLandmarks{{"Sn", Vec3(1.0, -39.0, 0.0)},
                                 {"Pg'", Vec3(3.0, -35.0, -18.0)},
                                 {"Ch-R", Vec3(-20.0, -30.0, -5.0)}};

geometry::TriangleMesh head() { return test::make_icosphere(40.0, 4); }

std::string error_of(const TargetSpec& spec, const plan::Landmarks& landmarks = kLandmarks) {
  const auto target = apply_target(spec, head(), landmarks);
  return target ? "" : target.error().message;
}

TEST(TargetSpec, LandmarksMoveToAByOrAlong) {
  TargetSpec spec;
  spec.landmarks = {
      {.name = "Sn", .to_L = Vec3(1, -42, 0)},
      {.name = "Pg'", .by_mm = Vec3(0, -4, 1)},
      {.name = "free", .at_L = Vec3(5, -38, 9), .towards_L = Vec3(0, -2, 0), .distance_mm = 3.0}};
  const FaceTarget target = apply_target(spec, head(), kLandmarks).value();
  EXPECT_EQ(target.landmarks[0].to_L, Vec3(1, -42, 0));
  EXPECT_EQ(target.landmarks[1].to_L, Vec3(3, -39, -17));
  EXPECT_EQ(*target.landmarks[2].direction_L, Vec3(0, -1, 0));
  EXPECT_EQ(target.landmarks[2].to_L, Vec3(5, -41, 9));
  spec.landmarks[0].name = "Xy";
  EXPECT_EQ(error_of(spec), "landmark Xy is not in the plan, and the target gives no at_mm for it");
}

TEST(TargetSpec, ProfilesAreInTheMidsagittalPlaneOfTheLandmarks) {
  TargetSpec spec;
  spec.profiles = {{.points = {{.z_mm = 5.0, .y_mm = -41.0}, {.z_mm = -7.0, .anterior_by_mm = 3.0}},
                    .polyline_mm = {{-44.0, 10.0}, {-42.0, 20.0}},
                    .spacing_mm = 2.5}};
  const FaceTarget target = apply_target(spec, head(), kLandmarks).value();
  const ProfileTarget& profile = target.profiles[0];
  EXPECT_EQ(profile.x_mm, 2.0);  // Mean of Sn and Pg'; Ch-R has a side.
  ASSERT_EQ(profile.points.size(), 2U + 5U);
  EXPECT_EQ(profile.points[0].y_mm, -41.0);
  EXPECT_NEAR(profile.points[1].y_mm, -std::sqrt(1600.0 - 49.0 - 4.0) - 3.0, 0.15);
  EXPECT_EQ(profile.points[3].z_mm, 12.5);
  EXPECT_NEAR(profile.points[3].y_mm, -43.5, 1e-12);
  EXPECT_EQ(error_of(spec, {}),
            "profile profile: x_mm of its plane is missing, and the plan has no landmarks in the "
            "midsagittal plane");
  spec.profiles[0].points[1].z_mm = 70.0;
  EXPECT_EQ(error_of(spec),
            "profile profile: there is no skin at the height 70 mm in the plane x = 2 mm");
}

geometry::RigidPath path(const std::string& segment, const Vec3& by_mm,
                         const Vec3& rotation_rad = Vec3::Zero()) {
  geometry::RigidPath path;
  path.segment = segment;
  path.keyframes = {
      {.translation_mm = by_mm, .rotation_rad = rotation_rad, .center_L = Vec3(1, 2, 3)}};
  return path;
}

TEST(TargetSpec, BodiesKeepTheRelativePoseOfThePlanOrOfTheScan) {
  const std::vector<geometry::RigidPath> paths{path("maxilla", Vec3(0, -6, 1), Vec3(0.1, 0, 0)),
                                               path("distal", Vec3(0, -2, 0)),
                                               path("chin", Vec3(0, -1, 0))};
  const std::vector<Vec3> centers(3, Vec3(9, 9, 9));
  TargetSpec spec;
  spec.bodies = {{.name = "jaws", .segments = {"maxilla", "distal"}}};
  const auto bodies = bodies_of(spec, paths, centers).value();
  ASSERT_EQ(bodies.size(), 2U);
  EXPECT_EQ(bodies[0].center_L, Vec3(1, 2, 3));  // Of the keyframe, which rotates.
  EXPECT_NEAR(bodies[0].start[1], 6.0, 1e-12);
  const MotionVariables variables = MotionVariables::create(bodies, 3).value();
  EXPECT_EQ(variables.count(), 6);  // The chin stays as in the plan.
  const auto planned = geometry::poses_at(paths, 1.0);
  const auto start = variables.poses(variables.start());
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_LT((start[k].matrix() - planned[k].matrix()).norm(), 1e-12) << k;
  spec.bodies[0].relative = RelativePose::kScan;
  const auto as_scanned =
      MotionVariables::create(bodies_of(spec, paths, centers).value(), 3).value();
  const auto poses = as_scanned.poses(as_scanned.start());
  EXPECT_LT((poses[0].matrix() - poses[1].matrix()).norm(), 1e-12);
  spec.bodies.push_back({.name = "again", .segments = {"distal"}});
  EXPECT_EQ(bodies_of(spec, paths, centers).error().message,
            "segment distal belongs to the bodies jaws and again");
  spec.bodies[1].segments = {"nose"};
  EXPECT_EQ(bodies_of(spec, paths, centers).error().message,
            "body again: the plan has no segment nose");
}

}  // namespace
}  // namespace lefort::inverse::test_target_spec
