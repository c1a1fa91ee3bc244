#include <lefort/uncertainty/chaos_basis.h>
#include <lefort/uncertainty/distribution.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lefort::uncertainty {
namespace {

std::vector<Distribution> examples() {
  return {{.kind = DistributionKind::kNormal, .mean = 2.0, .standard_deviation = 0.5},
          {.kind = DistributionKind::kTruncatedNormal,
           .mean = 1.0,
           .standard_deviation = 2.0,
           .low = -1.0,
           .high = 2.0},
          {.kind = DistributionKind::kUniform, .low = -3.0, .high = 5.0},
          {.kind = DistributionKind::kLogNormal, .mean = 4.0, .standard_deviation = 1.5},
          {.kind = DistributionKind::kTriangular, .low = 1.0, .high = 4.0, .mode = 2.0},
          {.kind = DistributionKind::kDiscrete,
           .values = {1.0, 2.0, 5.0, 6.0},
           .probabilities = {0.1, 0.4, 0.3, 0.2}}};
}

/// Mean of a function by the midpoint rule in the probability.
template <class Function>
double expectation(const Distribution& one, const Function& function) {
  constexpr int kPoints = 20000;
  std::vector<double> probabilities;
  for (int k = 0; k < kPoints; ++k) probabilities.push_back((k + 0.5) / kPoints);
  double sum = 0.0;
  for (const double x : quantiles(one, probabilities)) sum += function(x);
  return sum / kPoints;
}

}  // namespace

TEST(Distribution, MomentsAgreeWithQuantiles) {
  for (const Distribution& one : examples()) {
    const Moments moments = moments_of(one);
    EXPECT_NEAR(expectation(one, [](double x) { return x; }), moments.mean, 1e-3)
        << name_of(one.kind);
    EXPECT_NEAR(expectation(one, [&](double x) { return std::pow(x - moments.mean, 2); }),
                moments.variance, 5e-3 * moments.variance)
        << name_of(one.kind);
  }
}

TEST(Distribution, ALogNormalHasTheGivenMeanAndDeviation) {
  const Moments moments = moments_of(examples()[3]);
  EXPECT_NEAR(moments.mean, 4.0, 1e-12);
  EXPECT_NEAR(moments.variance, 1.5 * 1.5, 1e-12);
}

TEST(Distribution, QuantilesOfClosedForms) {
  EXPECT_NEAR(quantile(examples()[0], 0.975), 2.0 + 0.5 * 1.959963984540054, 1e-9);
  EXPECT_NEAR(quantile(examples()[2], 0.25), -1.0, 1e-12);
  // Triangular: (x - low)^2 = p (high - low) (mode - low) below the mode.
  EXPECT_NEAR(quantile(examples()[4], 0.12), 1.0 + std::sqrt(0.12 * 3.0), 1e-9);
  EXPECT_EQ(quantile(examples()[5], 0.05), 1.0);
  EXPECT_EQ(quantile(examples()[5], 0.45), 2.0);
  EXPECT_EQ(quantile(examples()[5], 0.999), 6.0);
}

TEST(Distribution, PolynomialsAreOrthonormal) {
  constexpr int kPoints = 20000;
  std::vector<double> probabilities;
  for (int k = 0; k < kPoints; ++k) probabilities.push_back((k + 0.5) / kPoints);
  for (const Distribution& one : examples()) {
    const auto rows = orthonormal_polynomials(one, 3, quantiles(one, probabilities));
    // Moments of a high order of a lognormal variable come from a tail that the rule does not reach.
    const bool has_tail = one.kind == DistributionKind::kLogNormal;
    for (std::size_t a = 0; a < (has_tail ? 3u : 4u); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        double product = 0.0;
        for (const auto& row : rows) product += row[a] * row[b] / kPoints;
        EXPECT_NEAR(product, a == b ? 1.0 : 0.0, has_tail ? 0.06 : 0.02)
            << name_of(one.kind) << " " << a << " " << b;
      }
  }
}

TEST(Distribution, GaussLevelsKeepMomentsAndPolynomials) {
  for (const Distribution& one : examples()) {
    if (one.kind == DistributionKind::kDiscrete) continue;
    const Distribution levels = gauss_levels(one, 3);
    const Moments exact = moments_of(one), found = moments_of(levels);
    EXPECT_NEAR(found.mean, exact.mean, 1e-9) << name_of(one.kind);
    EXPECT_NEAR(found.variance, exact.variance, 1e-8 * exact.variance) << name_of(one.kind);
    const auto continuous = orthonormal_polynomials(one, 2, levels.values);
    const auto discrete = orthonormal_polynomials(levels, 2, levels.values);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t n = 0; n < 3; ++n)
        EXPECT_NEAR(continuous[k][n], discrete[k][n], 1e-7) << name_of(one.kind) << " " << n;
  }
}

TEST(Distribution, NormalLevelsAreThoseOfGaussAndHermite) {
  const Distribution levels = gauss_levels(examples()[0], 3);
  EXPECT_NEAR(levels.values[0], 2.0 - 0.5 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(levels.probabilities[1], 2.0 / 3.0, 1e-12);
}

TEST(Distribution, InvalidParametersAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](const Distribution& one) {
    const Result<void> checked = check_distribution(one, "poisson");
    return checked ? std::string() : checked.error().message;
  };
  for (const Distribution& one : examples()) EXPECT_EQ(message(one), "") << name_of(one.kind);
  EXPECT_NE(message({.kind = DistributionKind::kNormal, .mean = nan}), "");
  EXPECT_NE(message({.kind = DistributionKind::kNormal, .standard_deviation = 0.0}), "");
  EXPECT_NE(message({.kind = DistributionKind::kUniform, .low = 1.0, .high = 1.0}), "");
  EXPECT_NE(message({.kind = DistributionKind::kUniform, .low = 0.0, .high = nan}), "");
  EXPECT_NE(message({.kind = DistributionKind::kLogNormal, .mean = -1.0}), "");
  EXPECT_NE(message({.kind = DistributionKind::kTriangular, .mode = 2.0}), "");
  EXPECT_NE(message({.kind = DistributionKind::kTruncatedNormal, .low = 20.0, .high = 21.0}), "");
  EXPECT_NE(message({.kind = DistributionKind::kDiscrete, .values = {1.0}, .probabilities = {1.0}}),
            "");
  EXPECT_NE(
      message(
          {.kind = DistributionKind::kDiscrete, .values = {1.0, 2.0}, .probabilities = {0.5, 0.6}}),
      "");
  EXPECT_NE(
      message(
          {.kind = DistributionKind::kDiscrete, .values = {2.0, 1.0}, .probabilities = {0.5, 0.5}}),
      "");
  EXPECT_EQ(message({.kind = DistributionKind::kUniform, .low = 1.0, .high = 1.0})
                .rfind("input poisson: ", 0),
            0u);
}

}  // namespace lefort::uncertainty
