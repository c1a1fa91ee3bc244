#include <lefort/plan/bones_of_landmarks.h>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace lefort::plan::test_bones_of_landmarks {
namespace {

/// Two segments that meet at x = 0, and the remainder above them, cut at z = 0.
CutSegments three_bones() {
  CutSegments cut;
  cut.segments_L = {test::make_box({-20, 0, -20}, {0, 10, 0}),
                    test::make_box({0, 0, -20}, {20, 10, 0})};
  cut.remainder_L = test::make_box({-20, 0, 0}, {20, 10, 30});
  return cut;
}

TEST(BonesOfLandmarks, AreTheClosestBone) {
  const Landmarks landmarks{{"Pg", {-10, -2, -10}},   // 2 mm off the first segment.
                            {"B", {10, 0, -5}},       // On the second.
                            {"N", {3, 0, 20}},        // On the remainder.
                            {"Me", {5, 0, -26}},      // 6 mm off all.
                            {"Pg'", {-10, 0, -10}}};  // Of the skin.
  const auto bones = bones_of_landmarks(landmarks, three_bones());
  ASSERT_EQ(bones.size(), 5U);
  EXPECT_EQ(bones[0], 0U);
  EXPECT_EQ(bones[1], 1U);
  EXPECT_EQ(bones[2], 2U);
  EXPECT_FALSE(bones[3]);
  EXPECT_FALSE(bones[4]);
}

TEST(BonesOfLandmarks, OnACutAreTheSegmentNotTheRemainder) {
  const Landmarks landmarks{{"A", {-10, -1, 0.2}}, {"ANS", {0.1, 0, -10}}, {"PNS", {10, 0, 2}}};
  const auto bones = bones_of_landmarks(landmarks, three_bones());
  EXPECT_EQ(bones[0], 0U) << "equally close to segment and remainder";
  EXPECT_EQ(bones[1], 0U) << "between two segments, the first";
  EXPECT_EQ(bones[2], 2U);
}

}  // namespace
}  // namespace lefort::plan::test_bones_of_landmarks
