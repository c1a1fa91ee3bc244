/// \file
/// Statistics over cases: bootstrap and agreement.
#include <lefort/compare/agreement.h>
#include <lefort/compare/bootstrap.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace lefort::compare::test_cohort_statistics {
namespace {

double mean_of(const std::vector<double>& values, std::span<const Index> chosen) {
  double sum = 0.0;
  for (const Index k : chosen) sum += values[std::size_t(k)];
  return sum / double(chosen.size());
}

TEST(Bootstrap, TheIntervalOfAMeanHasTheWidthOfItsStandardError) {
  std::vector<double> values(100);
  std::iota(values.begin(), values.end(), 0.0);  // Standard deviation 28.87 (population).
  const auto interval = bootstrap_interval(
      100, [&](std::span<const Index> chosen) { return mean_of(values, chosen); },
      {.replicates = 4000});
  EXPECT_NEAR(interval.low, 49.5 - 1.96 * 2.887, 0.4);
  EXPECT_NEAR(interval.high, 49.5 + 1.96 * 2.887, 0.4);
}

TEST(Bootstrap, TheSameSeedGivesTheSameSamples) {
  const BootstrapOptions first{.replicates = 5, .seed = 3}, other{.replicates = 5, .seed = 4};
  EXPECT_EQ(bootstrap_samples(7, first), bootstrap_samples(7, first));
  EXPECT_NE(bootstrap_samples(7, first), bootstrap_samples(7, other));
  for (const auto& sample : bootstrap_samples(7, first)) {
    ASSERT_EQ(sample.size(), 7U);
    for (const Index k : sample) EXPECT_TRUE(k >= 0 && k < 7);
  }
}

/// The first number of the generator of the C++ standard with its default seed.
TEST(Bootstrap, SamplesDoNotDependOnTheLibrary) {
  EXPECT_EQ(bootstrap_samples(1000, {.replicates = 1, .seed = 5489})[0][0],
            Index(14514284786278117030ULL % 1000));
}

TEST(Bootstrap, PercentilesAreInterpolated) {
  const std::vector<double> values{4.0, 1.0, 3.0, std::numeric_limits<double>::quiet_NaN(),
                                   2.0, 0.0};
  const Interval interval = percentile_interval(values, 0.75);
  EXPECT_DOUBLE_EQ(interval.low, 0.5);
  EXPECT_DOUBLE_EQ(interval.high, 3.5);
}

TEST(Bootstrap, OneCaseHasNoInterval) {
  const auto interval = bootstrap_interval(1, [](std::span<const Index>) { return 1.0; });
  EXPECT_TRUE(std::isnan(interval.low));
  EXPECT_TRUE(std::isnan(interval.high));
}

TEST(Agreement, HasBiasAndLimits) {
  const std::vector<double> first{1.0, 2.0, 6.0, 9.0}, second{0.0, 2.0, 4.0, 8.0};
  const Agreement agreement = agreement_of(first, second);  // Differences 1, 0, 2, 1.
  EXPECT_EQ(agreement.pairs, 4);
  EXPECT_DOUBLE_EQ(agreement.bias, 1.0);
  EXPECT_DOUBLE_EQ(agreement.standard_deviation, std::sqrt(2.0 / 3.0));
  EXPECT_DOUBLE_EQ(agreement.limits.high, 1.0 + 1.96 * std::sqrt(2.0 / 3.0));
}

TEST(Agreement, IgnoresMissingPairs) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> first{1.0, none}, second{0.5, 2.0};
  const Agreement agreement = agreement_of(first, second);
  EXPECT_EQ(agreement.pairs, 1);
  EXPECT_DOUBLE_EQ(agreement.bias, 0.5);
  EXPECT_TRUE(std::isnan(agreement.limits.low));
}

}  // namespace
}  // namespace lefort::compare::test_cohort_statistics
