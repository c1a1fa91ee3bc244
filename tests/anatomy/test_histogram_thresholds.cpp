#include <lefort/anatomy/histogram_thresholds.h>
#include <lefort/anatomy/synthetic_head.h>

#include <gtest/gtest.h>

namespace lefort::anatomy::test_histogram_thresholds {
namespace {

TEST(HistogramThresholds, LieBetweenAirSoftTissueAndBone) {
  const auto found = find_thresholds(synthetic_scan(synthetic_grid(3.0)));
  ASSERT_TRUE(found) << found.error().message;
  // Voxels of 3 mm: many contain a border, which moves the means towards each other.
  EXPECT_NEAR(found->air_mean_hu, -990.0, 15.0);
  EXPECT_NEAR(found->soft_mean_hu, 40.0, 25.0);
  EXPECT_NEAR(found->bone_mean_hu, 810.0, 50.0);
  EXPECT_NEAR(found->skin_hu, -475.0, 60.0);
  EXPECT_NEAR(found->bone_hu, 450.0, 50.0);
}

TEST(HistogramThresholds, FollowAnotherScale) {
  // Values of a cone-beam scanner: air is 0, and the scale is half.
  const image::CtVolume ct = synthetic_scan(synthetic_grid(3.0));
  image::CtVolume other = ct;
  for (std::int16_t& value : other.values) value = std::int16_t((value + 1024) / 2);
  const auto hu = find_thresholds(ct).value();
  const auto found = find_thresholds(other).value();
  EXPECT_NEAR(found.skin_hu, (hu.skin_hu + 1024.0) / 2.0, 8.0);
  EXPECT_NEAR(found.bone_hu, (hu.bone_hu + 1024.0) / 2.0, 8.0);
}

TEST(HistogramThresholds, RequireThreeValues) {
  image::CtVolume ct{{.size = {2, 2, 2}}, {0, 0, 0, 1000, 1000, 1000, 1000, 1000}};
  EXPECT_EQ(find_thresholds(ct).error().code, ErrorCode::kAnatomyMissing);
  ct.values.assign(8, 7);
  EXPECT_EQ(find_thresholds(ct).error().code, ErrorCode::kAnatomyMissing);
  EXPECT_EQ(find_thresholds({}).error().code, ErrorCode::kAnatomyMissing);
}

}  // namespace
}  // namespace lefort::anatomy::test_histogram_thresholds
