#include <lefort/compare/difference_statistics.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lefort::compare::test_difference_statistics {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
bool everywhere(Index) { return true; }

TEST(DifferenceStatistics, AreWeightedByArea) {
  // 1 mm on nine tenths of the area, in one vertex; 3 mm inwards on the rest, in two.
  const SurfaceDifference difference{{1.0, -3.0, -3.0}, {9.0, 0.5, 0.5}};
  const DifferenceStatistics reported = describe(difference, everywhere);
  EXPECT_DOUBLE_EQ(reported.area_mm2, 10.0);
  EXPECT_DOUBLE_EQ(reported.compared_fraction, 1.0);
  EXPECT_DOUBLE_EQ(reported.mean_mm, 1.2);
  EXPECT_DOUBLE_EQ(reported.mean_signed_mm, 0.6);
  EXPECT_DOUBLE_EQ(reported.median_mm, 1.0);
  EXPECT_DOUBLE_EQ(reported.p90_mm, 1.0);
  EXPECT_DOUBLE_EQ(reported.p95_mm, 3.0);
  EXPECT_DOUBLE_EQ(reported.p99_mm, 3.0);
  EXPECT_DOUBLE_EQ(reported.max_mm, 3.0);
  EXPECT_DOUBLE_EQ(reported.fraction_below_1mm, 0.0);
  EXPECT_DOUBLE_EQ(reported.fraction_below_2mm, 0.9);
}

TEST(DifferenceStatistics, ReportsTheLastPercentileSeparately) {
  const DifferenceStatistics reported = describe({{1.0, 2.0, 5.0}, {96.0, 3.5, 0.5}}, everywhere);
  EXPECT_DOUBLE_EQ(reported.p95_mm, 1.0);
  EXPECT_DOUBLE_EQ(reported.p99_mm, 2.0);
  EXPECT_DOUBLE_EQ(reported.max_mm, 5.0);
}

TEST(DifferenceStatistics, CountsTheAreaThatIsNotCompared) {
  const SurfaceDifference difference{{0.5, kNaN, 9.0}, {1.0, 3.0, 5.0}};
  const DifferenceStatistics reported = describe(difference, [](Index v) { return v < 2; });
  EXPECT_DOUBLE_EQ(reported.area_mm2, 4.0);
  EXPECT_DOUBLE_EQ(reported.compared_fraction, 0.25);
  EXPECT_DOUBLE_EQ(reported.max_mm, 0.5);
  EXPECT_DOUBLE_EQ(reported.fraction_below_1mm, 1.0);
}

TEST(DifferenceStatistics, AreNanIfNothingIsCompared) {
  const DifferenceStatistics reported = describe({{kNaN}, {2.0}}, everywhere);
  EXPECT_DOUBLE_EQ(reported.area_mm2, 2.0);
  EXPECT_DOUBLE_EQ(reported.compared_fraction, 0.0);
  for (const double d : {reported.mean_mm, reported.median_mm, reported.p90_mm, reported.p95_mm,
                         reported.p99_mm, reported.max_mm, reported.fraction_below_1mm,
                         reported.fraction_below_2mm, reported.mean_signed_mm})
    EXPECT_TRUE(std::isnan(d));
}

}  // namespace
}  // namespace lefort::compare::test_difference_statistics
