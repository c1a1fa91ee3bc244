#include <lefort/contact/rest_gap.h>

#include <gtest/gtest.h>

namespace lefort::contact::test_rest_gap {
namespace {

constexpr double kSnap_mm = 0.8;

Gap gap(double mm, field::Zone zone = field::Zone::kBand) { return {.zone = zone, .gap_mm = mm}; }

TEST(RestGap, OfTheBoneItselfIsTheGapOfAPatchAndZeroFurtherAway) {
  for (const double mm : {-1.5, -0.3, 0.0, 0.5, kSnap_mm})
    EXPECT_EQ(rest_gap_mm(gap(mm), gap(mm), kSnap_mm), mm);
  EXPECT_EQ(rest_gap_mm(gap(1.7), gap(1.7), kSnap_mm), 0.0);
}

TEST(RestGap, ContactBeginsWhenTheClearanceToTheBoneIsUsedUp) {
  EXPECT_EQ(rest_gap_mm(gap(1.0), gap(0.2), kSnap_mm), 1.0);    // Touches the bone.
  EXPECT_EQ(rest_gap_mm(gap(-1.0), gap(0.2), kSnap_mm), -1.0);  // The obstacle is too large.
  EXPECT_EQ(rest_gap_mm(gap(3.0), gap(2.0), kSnap_mm), 1.0);
  EXPECT_EQ(rest_gap_mm(gap(1.5), gap(2.0), kSnap_mm), -0.5);
  EXPECT_EQ(rest_gap_mm(gap(0.4), gap(-1.0), kSnap_mm), 0.4);  // In the bone at rest.
}

TEST(RestGap, BeyondTheRangeContactBeginsAtTheObstacle) {
  EXPECT_EQ(rest_gap_mm(gap(1.0), gap(4.0, field::Zone::kOutside), kSnap_mm), 0.0);
  EXPECT_EQ(rest_gap_mm(gap(4.0, field::Zone::kOutside), gap(0.1), kSnap_mm), 0.0);
}

TEST(RestGap, WithoutSnapDistanceOnlyTissueInBoneHasOne) {
  EXPECT_EQ(rest_gap_mm(gap(0.3), gap(0.3), 0.0), 0.0);
  EXPECT_EQ(rest_gap_mm(gap(-0.3), gap(-0.3), 0.0), -0.3);
}

}  // namespace
}  // namespace lefort::contact::test_rest_gap
