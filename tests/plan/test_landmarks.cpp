#include <lefort/plan/landmarks.h>

#include <gtest/gtest.h>

namespace lefort::plan::test_landmarks {
namespace {

TEST(Landmarks, NamesOfPairsHaveSides) {
  EXPECT_EQ(full_name("Or-R"), "right orbitale");
  EXPECT_EQ(full_name("Or-L"), "left orbitale");
  EXPECT_EQ(full_name("N'"), "soft-tissue nasion");
  EXPECT_EQ(landmark_definition("Or"), nullptr);
  EXPECT_EQ(landmark_definition("N-R"), nullptr);
  EXPECT_EQ(full_name("screw 3"), "screw 3");
  for (const LandmarkKind& kind : landmark_kinds())
    EXPECT_EQ(landmark_definition(std::string(kind.abbreviation) + (kind.is_paired ? "-L" : "")),
              &kind);
}

TEST(Landmarks, MidpointIsThatOfBothSidesOrTheExistingOne) {
  const Landmarks both{{"Or-R", {-30, 0, 0}}, {"Or-L", {32, 4, 2}}};
  EXPECT_EQ(*pair_midpoint(both, "Or"), Vec3(1, 2, 1));
  EXPECT_EQ(*pair_midpoint(Landmarks{both[1]}, "Or"), both[1].point_L);
  EXPECT_FALSE(pair_midpoint(both, "Po"));
}

TEST(Landmarks, LeftAxisDoesNotDependOnTheOrder) {
  EXPECT_EQ(patient_left_axis(Landmarks{}).value(), Vec3(1, 0, 0));
  const Landmarks turned{{"Or-L", {24, 18, 0}}, {"N", {0, 0, 0}}, {"Or-R", {-24, -18, 0}}};
  EXPECT_LT((patient_left_axis(turned).value() - Vec3(0.8, 0.6, 0)).norm(), 1e-15);
  const Landmarks others{{"Or-L", {30, 0, 0}},
                         {"Or-R", {-30, 0, 0}},  // Not standard landmarks.
                         {"screw-L", {-5, 9, 0}},
                         {"screw-R", {5, 0, 0}}};
  EXPECT_EQ(patient_left_axis(others).value(), Vec3(1, 0, 0));
}

/// An asymmetric face.
Landmarks asymmetric() {
  return {{"N", {1, -66, 30}},      {"ANS", {2, -70, -25}},   {"Or-R", {-32, -55, 2}},
          {"Or-L", {35, -52, 4}},   {"Po-R", {-58, 15, 2}},   {"Po-L", {61, 19, -1}},
          {"FZ-R", {-48, -48, 26}}, {"U6-L", {26, -40, -44}}, {"Prn", {3, -90, -10}}};
}

void expect_refused(const Landmarks& landmarks, const char* words) {
  const auto left = patient_left_axis(landmarks);
  ASSERT_FALSE(left) << words;
  EXPECT_EQ(left.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(left.error().message.find(words), std::string::npos) << left.error().message;
}

TEST(Landmarks, RejectsExchangedSidesByName) {
  ASSERT_TRUE(patient_left_axis(asymmetric())) << patient_left_axis(asymmetric()).error().message;
  Landmarks one = asymmetric();
  std::swap(one[2].name, one[3].name);
  expect_refused(one, "landmarks Or-R and Or-L");
  std::swap(one[4].name, one[5].name);
  expect_refused(one, "are they exchanged?");
  Landmarks sideways = asymmetric();
  sideways[3].point_L = sideways[2].point_L + Vec3(0, 60, 0);
  expect_refused(sideways, "Or-R and Or-L");
}

TEST(Landmarks, RejectsASideBeyondTheMidPlaneByName) {
  Landmarks one = asymmetric();
  one[6].name = "FZ-L";
  expect_refused(one, "landmark FZ-L lies");
  one = asymmetric();
  one[7].name = "U6-R";
  expect_refused(one, "landmark U6-R lies");
}

TEST(Landmarks, FindsARepeatedName) {
  EXPECT_FALSE(first_repeated_name(Landmarks{{"A", {0, 0, 0}}, {"B", {0, 0, 0}}}));
  EXPECT_EQ(first_repeated_name(Landmarks{{"A", {0, 0, 0}}, {"B", {0, 0, 0}}, {"A", {1, 0, 0}}}),
            "A");
}

}  // namespace
}  // namespace lefort::plan::test_landmarks
