#include <lefort/compare/difference_statistics.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lefort::compare {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
bool everywhere(Index) { return true; }

TEST(DifferenceStatistics, AreOverAreaAndNotOverVertices) {
  // 1 mm on nine tenths of the area, in one vertex; 3 mm inwards on the rest, in two.
  const SurfaceDifference difference{{1.0, -3.0, -3.0}, {9.0, 0.5, 0.5}};
  const DifferenceStatistics told = describe(difference, everywhere);
  EXPECT_DOUBLE_EQ(told.area_mm2, 10.0);
  EXPECT_DOUBLE_EQ(told.compared_share, 1.0);
  EXPECT_DOUBLE_EQ(told.mean_mm, 1.2);
  EXPECT_DOUBLE_EQ(told.mean_signed_mm, 0.6);
  EXPECT_DOUBLE_EQ(told.median_mm, 1.0);
  EXPECT_DOUBLE_EQ(told.p90_mm, 1.0);
  EXPECT_DOUBLE_EQ(told.p95_mm, 3.0);
  EXPECT_DOUBLE_EQ(told.p99_mm, 3.0);
  EXPECT_DOUBLE_EQ(told.max_mm, 3.0);
  EXPECT_DOUBLE_EQ(told.share_below_1mm, 0.0);
  EXPECT_DOUBLE_EQ(told.share_below_2mm, 0.9);
}

TEST(DifferenceStatistics, TellTheLastHundredthApart) {
  const DifferenceStatistics told = describe({{1.0, 2.0, 5.0}, {96.0, 3.5, 0.5}}, everywhere);
  EXPECT_DOUBLE_EQ(told.p95_mm, 1.0);
  EXPECT_DOUBLE_EQ(told.p99_mm, 2.0);
  EXPECT_DOUBLE_EQ(told.max_mm, 5.0);
}

TEST(DifferenceStatistics, WhatIsNotComparedIsCountedApart) {
  const SurfaceDifference difference{{0.5, kNaN, 9.0}, {1.0, 3.0, 5.0}};
  const DifferenceStatistics told = describe(difference, [](Index v) { return v < 2; });
  EXPECT_DOUBLE_EQ(told.area_mm2, 4.0);
  EXPECT_DOUBLE_EQ(told.compared_share, 0.25);
  EXPECT_DOUBLE_EQ(told.max_mm, 0.5);
  EXPECT_DOUBLE_EQ(told.share_below_1mm, 1.0);
}

TEST(DifferenceStatistics, OfNothingAreNoNumbers) {
  const DifferenceStatistics told = describe({{kNaN}, {2.0}}, everywhere);
  EXPECT_DOUBLE_EQ(told.area_mm2, 2.0);
  EXPECT_DOUBLE_EQ(told.compared_share, 0.0);
  for (const double d :
       {told.mean_mm, told.median_mm, told.p90_mm, told.p95_mm, told.p99_mm, told.max_mm,
        told.share_below_1mm, told.share_below_2mm, told.mean_signed_mm})
    EXPECT_TRUE(std::isnan(d));
}

}  // namespace
}  // namespace lefort::compare
