#include <lefort/plan/landmarks.h>

#include <gtest/gtest.h>

namespace lefort::plan {
namespace {

TEST(Landmarks, NamesHaveSidesWhereTheFieldHasPairs) {
  EXPECT_EQ(full_name("Or-R"), "right orbitale");
  EXPECT_EQ(full_name("Or-L"), "left orbitale");
  EXPECT_EQ(full_name("N'"), "soft-tissue nasion");
  EXPECT_EQ(find_kind("Or"), nullptr);
  EXPECT_EQ(find_kind("N-R"), nullptr);
  EXPECT_EQ(full_name("screw 3"), "screw 3");
  for (const LandmarkKind& kind : landmark_kinds())
    EXPECT_EQ(find_kind(std::string(kind.abbreviation) + (kind.is_paired ? "-L" : "")), &kind);
}

TEST(Landmarks, TheMiddleIsOfBothSidesOrOfTheOneThereIs) {
  const Landmarks both{{"Or-R", {-30, 0, 0}}, {"Or-L", {32, 4, 2}}};
  EXPECT_EQ(*find_middle(both, "Or"), Vec3(1, 2, 1));
  EXPECT_EQ(*find_middle(Landmarks{both[1]}, "Or"), both[1].point_L);
  EXPECT_FALSE(find_middle(both, "Po"));
}

TEST(Landmarks, LeftIsToThePatientsLeftWhateverTheOrder) {
  EXPECT_EQ(left_of(Landmarks{}), Vec3(1, 0, 0));
  const Landmarks turned{{"Or-L", {0, 30, 0}}, {"N", {0, 0, 0}}, {"Or-R", {0, -30, 0}}};
  EXPECT_EQ(left_of(turned), Vec3(0, 1, 0));
}

TEST(Landmarks, ARepeatedNameIsFound) {
  EXPECT_FALSE(first_repeated_name(Landmarks{{"A", {0, 0, 0}}, {"B", {0, 0, 0}}}));
  EXPECT_EQ(first_repeated_name(Landmarks{{"A", {0, 0, 0}}, {"B", {0, 0, 0}}, {"A", {1, 0, 0}}}),
            "A");
}

}  // namespace
}  // namespace lefort::plan
