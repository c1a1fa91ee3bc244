/// \file
/// Distribution of an uncertain input. A value; inputs are independent.
#pragma once

#include <lefort/core/error.h>

#include <string>
#include <string_view>
#include <vector>

namespace lefort::uncertainty {

enum class DistributionKind {
  kNormal,           ///< mean, standard_deviation.
  kTruncatedNormal,  ///< A normal distribution between low and high, scaled to probability 1.
  kUniform,          ///< low, high.
  kLogNormal,        ///< mean and standard_deviation of the variable itself, not of its logarithm.
  kTriangular,       ///< low, mode, high.
  kDiscrete,         ///< values with probabilities.
};

/// Names in files: "normal", "truncated normal", "uniform", "lognormal", "triangular", "discrete".
[[nodiscard]] std::string_view name_of(DistributionKind kind);

/// Members that the kind does not use are ignored.
struct Distribution {
  DistributionKind kind = DistributionKind::kNormal;
  double mean = 0.0;
  double standard_deviation = 1.0;      ///< > 0. Of a truncated normal: before the truncation.
  double low = 0.0, high = 1.0;         ///< low < high.
  double mode = 0.5;                    ///< low <= mode <= high.
  std::vector<double> values{};         ///< Ascending, two or more.
  std::vector<double> probabilities{};  ///< One per value, > 0, with the sum 1.
};

/// \param name  of the input, for the message.
/// \returns nothing, or kInvalidArgument with the parameter that is out of range.
[[nodiscard]] Result<void> check_distribution(const Distribution& distribution,
                                              const std::string& name);

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

/// \pre check_distribution() passes, as for all functions below.
[[nodiscard]] Moments moments_of(const Distribution& distribution);

/// \param probability  of (0, 1).
/// \returns the value that the variable does not exceed with this probability.
[[nodiscard]] double quantile(const Distribution& distribution, double probability);

/// Quantiles of many probabilities; faster than one at a time.
[[nodiscard]] std::vector<double> quantiles(const Distribution& distribution,
                                            const std::vector<double>& probabilities);

/// The discrete distribution on the nodes of the Gauss quadrature of a distribution. It has the
/// same moments up to the order 2 `levels` - 1, and the same orthonormal polynomials up to the
/// degree `levels` - 1 \cite gautschi2004.
///
/// \param distribution  not discrete.
/// \param levels        number of nodes, 2 to 9.
[[nodiscard]] Distribution gauss_levels(const Distribution& distribution, int levels);

/// Orthonormal polynomials of a distribution at given points: row i has the values of degree 0 to
/// `degree` at points[i]. The constant polynomial is 1.
///
/// \param degree  0 to 20; less than the number of values of a discrete distribution.
[[nodiscard]] std::vector<std::vector<double>> orthonormal_polynomials(
    const Distribution& distribution, int degree, const std::vector<double>& points);

}  // namespace lefort::uncertainty
