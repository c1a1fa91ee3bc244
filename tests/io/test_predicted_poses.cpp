/// \file
/// Poses of segments in prediction.json, of this version and of others.
#include <lefort/io/predicted_poses.h>

#include <gtest/gtest.h>

namespace lefort::io::test_predicted_poses {
namespace {

using nlohmann::json;

json document() {
  return json::parse(R"({
    "lefort_prediction": 2,
    "steps": [{"segments": [
      {"name": "left",
       "pose_4x4_row_major_mm_lps": [0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1]},
      {"name": "right",
       "pose_4x4_row_major_mm_lps": [1, 0, 0, 0, 0, 1, 0, -2, 0, 0, 1, 0, 0, 0, 0, 1]}
    ]}]
  })");
}

TEST(PredictedPoses, AreThoseOfEachSegment) {
  const json all = document();
  const auto poses = predicted_poses(all, all["steps"][0]).value();
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].segment, "left");
  EXPECT_EQ(Vec3(poses[0].X_LB * Vec3(1, 0, 0)), Vec3(5, 7, 7));
  EXPECT_EQ(poses[1].segment, "right");
  EXPECT_EQ(Vec3(poses[1].X_LB.translation()), Vec3(0, -2, 0));
}

TEST(PredictedPoses, OfAnotherVersionAskForANewPrediction) {
  json old = document();
  old["lefort_prediction"] = 1;
  const auto rejected = predicted_poses(old, old["steps"][0]);
  ASSERT_FALSE(rejected);
  EXPECT_EQ(rejected.error().code, ErrorCode::kFileUnsupported);
  EXPECT_EQ(rejected.error().message,
            "the prediction was written by another version of the program: predict again");
}

TEST(PredictedPoses, DamagedOnesAreRefused) {
  for (const char* patch :
       {R"([{"op": "remove", "path": "/steps/0/segments"}])",
        R"([{"op": "replace", "path": "/steps/0/segments", "value": []}])",
        R"([{"op": "remove", "path": "/steps/0/segments/0/name"}])",
        R"([{"op": "remove", "path": "/steps/0/segments/0/pose_4x4_row_major_mm_lps/15"}])",
        R"([{"op": "replace", "path": "/steps/0/segments/0/pose_4x4_row_major_mm_lps/1",
             "value": -2}])",
        R"([{"op": "replace", "path": "/steps/0/segments/0/pose_4x4_row_major_mm_lps/12",
             "value": 1}])",
        R"([{"op": "replace", "path": "/steps/0/segments/0/pose_4x4_row_major_mm_lps",
             "value": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}])"}) {
    const json damaged = document().patch(json::parse(patch));
    const auto rejected = predicted_poses(damaged, damaged["steps"][0]);
    ASSERT_FALSE(rejected) << patch;
    EXPECT_EQ(rejected.error().code, ErrorCode::kFileCorrupt) << patch;
  }
}

}  // namespace
}  // namespace lefort::io::test_predicted_poses
