#include <lefort/contact/bone_overlap.h>
#include <lefort/core/parallel.h>
#include <lefort/field/build/build_distance_field.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>

#include "support/shapes.h"

namespace lefort::contact::test_bone_overlap {
namespace {

/// A surface and its field.
struct Bone {
  geometry::TriangleMesh surface_B;
  std::shared_ptr<const DistanceQuery> distance_query_B;

  explicit Bone(geometry::TriangleMesh surface) : surface_B(std::move(surface)) {
    distance_query_B =
        field_distance_query(
            std::make_shared<const field::DistanceField>(
                field::build_distance_field(surface_B, {.resolution = 128, .band_mm = 2.5})
                    .value()),
            DetectionMethod::kTrilinear)
            .value();
  }
  [[nodiscard]] SolidBone at(const Vec3& shift) const {
    RigidTransform X_LB = RigidTransform::Identity();
    X_LB.translation() = shift;
    return {&surface_B, {distance_query_B, X_LB}};
  }
};

const Bone& ball() {
  static const Bone bone(test::make_icosphere(6.0, 5));
  return bone;
}

TEST(BoneOverlap, OfTwoBallsIsALens) {
  constexpr double kDistance_mm = 10.0, kRadius_mm = 6.0;
  const BoneOverlap found =
      measure_overlap(ball().at(Vec3(kDistance_mm, 0.0, 0.0)), ball().at(Vec3::Zero()), 0.3);
  const double height = 2.0 * kRadius_mm - kDistance_mm;
  const double lens_mm3 = std::numbers::pi / 12.0 * height * height *
                          (kDistance_mm * kDistance_mm + 4.0 * kDistance_mm * kRadius_mm) /
                          kDistance_mm;
  EXPECT_NEAR(found.volume_mm3, lens_mm3, 0.03 * lens_mm3);
  EXPECT_NEAR(found.deepest_mm, 2.0, 0.03);
  EXPECT_LT(
      std::min((found.deepest_L - Vec3(4, 0, 0)).norm(), (found.deepest_L - Vec3(6, 0, 0)).norm()),
      0.3);
  EXPECT_FALSE(found.depth_is_lower_bound);
  ASSERT_EQ(found.depth_mm.size(), ball().surface_B.vertices.size());
  for (std::size_t v = 0; v < found.depth_mm.size(); ++v) {
    const double in_mm =
        kRadius_mm - (ball().surface_B.vertices[v] + Vec3(kDistance_mm, 0.0, 0.0)).norm();
    EXPECT_NEAR(found.depth_mm[v], in_mm > kTouching_mm ? in_mm : 0.0,
                std::abs(in_mm - kTouching_mm) < 0.02 ? 0.13 : 0.03);
  }
}

TEST(BoneOverlap, IsTheSameForTurnedBones) {
  const Bone long_bone(test::make_box({-8, -1, -1}, {8, 1, 1}));
  RigidTransform X = RigidTransform::Identity();
  X.rotate(Eigen::AngleAxisd(0.9, Vec3(1.0, 2.0, -1.0).normalized()));
  X.pretranslate(Vec3(20.0, -5.0, 3.0));
  SolidBone turned = long_bone.at(Vec3(9.0, 0.0, 0.0)), turned_ball = ball().at(Vec3::Zero());
  const BoneOverlap before = measure_overlap(turned, turned_ball, 0.3);
  turned.obstacle.X_LB = X * turned.obstacle.X_LB;
  turned_ball.obstacle.X_LB = X * turned_ball.obstacle.X_LB;
  const BoneOverlap after = measure_overlap(turned, turned_ball, 0.3);
  EXPECT_GT(before.deepest_mm, 1.0);
  EXPECT_NEAR(after.deepest_mm, before.deepest_mm, 1e-6);
  EXPECT_NEAR(after.volume_mm3, before.volume_mm3, 0.05 * before.volume_mm3);
}

TEST(BoneOverlap, SeparateAndTouchingBonesDoNotOverlap) {
  for (const double apart_mm : {20.0, 12.5, 12.0, 11.95}) {
    const BoneOverlap found =
        measure_overlap(ball().at(Vec3(apart_mm, 0.0, 0.0)), ball().at(Vec3::Zero()), 0.3);
    EXPECT_FALSE(found.overlaps()) << apart_mm;
    EXPECT_EQ(found.volume_mm3, 0.0);
  }
}

TEST(BoneOverlap, TheTwoSidesOfACutTouch) {
  const Bone low(test::make_box({0, 0, 0}, {10, 10, 5})),
      high(test::make_box({0, 0, 5}, {10, 10, 10}));
  EXPECT_FALSE(measure_overlap(high.at(Vec3::Zero()), low.at(Vec3::Zero()), 0.5).overlaps());
  const BoneOverlap pushed = measure_overlap(high.at(Vec3(0, 0, -1)), low.at(Vec3::Zero()), 0.5);
  EXPECT_NEAR(pushed.deepest_mm, 1.0, 0.02);
  EXPECT_NEAR(pushed.volume_mm3, 100.0, 5.0);
}

TEST(BoneOverlap, AWallPiercedByEdgesAloneIsFound) {
  // The vertices of the needle are far from the plate, and those of the plate far from the needle.
  const Bone plate(test::make_box({-10, -10, -1}, {10, 10, 1}));
  const Bone needle(test::make_box({-0.4, -0.4, -8}, {0.4, 0.4, 8}));
  const BoneOverlap found =
      measure_overlap(needle.at(Vec3(3.0, 2.0, 0.0)), plate.at(Vec3::Zero()), 0.3);
  EXPECT_EQ(*std::max_element(found.depth_mm.begin(), found.depth_mm.end()), 0.0);
  EXPECT_NEAR(found.deepest_mm, 1.0, 0.1);
  EXPECT_LT(std::abs(found.deepest_L.z()), 0.3);
}

TEST(BoneOverlap, ADepthBeyondTheQueryRangeIsALowerBound) {
  const Bone small(test::make_icosphere(3.0, 4));
  const Bone large(test::make_icosphere(10.0, 5));
  const BoneOverlap found =
      measure_overlap(small.at(Vec3(1.0, 0.0, 0.0)), large.at(Vec3::Zero()), 0.3);
  EXPECT_TRUE(found.depth_is_lower_bound);
  EXPECT_NEAR(found.deepest_mm, 2.5, 0.01);
  EXPECT_NEAR(found.volume_mm3, 36.0 * std::numbers::pi, 3.0);
}

TEST(BoneOverlap, SameBitsForAnyNumberOfThreads) {
  const auto with = [](int threads) {
    const ThreadLimit limit(threads);
    return measure_overlap(ball().at(Vec3(10.0, 0.5, 0.0)), ball().at(Vec3::Zero()), 0.3);
  };
  const BoneOverlap one = with(1), two = with(2);
  EXPECT_EQ(one.volume_mm3, two.volume_mm3);
  EXPECT_EQ(one.deepest_mm, two.deepest_mm);
  EXPECT_EQ(one.deepest_L, two.deepest_L);
}

}  // namespace
}  // namespace lefort::contact::test_bone_overlap
