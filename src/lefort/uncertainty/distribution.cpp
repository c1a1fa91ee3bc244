#include <lefort/core/check.h>
#include <lefort/uncertainty/distribution.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <openturns/LogNormal.hxx>
#include <openturns/LogNormalMuSigma.hxx>
#include <openturns/Normal.hxx>
#include <openturns/ParametrizedDistribution.hxx>
#include <openturns/StandardDistributionPolynomialFactory.hxx>
#include <openturns/Triangular.hxx>
#include <openturns/TruncatedNormal.hxx>
#include <openturns/Uniform.hxx>

namespace lefort::uncertainty {
namespace {

/// The logarithm of a lognormal variable: normal, with these parameters.
struct LogParameters {
  double mu, sigma;
};

LogParameters log_parameters(const Distribution& one) {
  const double ratio = one.standard_deviation / one.mean;
  const double sigma2 = std::log1p(ratio * ratio);
  return {std::log(one.mean) - 0.5 * sigma2, std::sqrt(sigma2)};
}

/// \pre not discrete.
OT::Distribution continuous(const Distribution& one) {
  switch (one.kind) {
    case DistributionKind::kTruncatedNormal:
      return OT::TruncatedNormal(one.mean, one.standard_deviation, one.low, one.high);
    case DistributionKind::kUniform:
      return OT::Uniform(one.low, one.high);
    case DistributionKind::kLogNormal: {
      const auto [mu, sigma] = log_parameters(one);
      return OT::LogNormal(mu, sigma, 0.0);
    }
    case DistributionKind::kTriangular:
      return OT::Triangular(one.low, one.mode, one.high);
    default:
      return OT::Normal(one.mean, one.standard_deviation);
  }
}

Result<void> invalid(const std::string& name, const std::string& problem) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("input {}: {}", name, problem));
}

Result<void> check_discrete(const Distribution& one, const std::string& name) {
  if (one.values.size() < 2 || one.values.size() != one.probabilities.size())
    return invalid(name, fmt::format("{} values and {} probabilities, must be as many, two or more",
                                     one.values.size(), one.probabilities.size()));
  for (std::size_t k = 0; k < one.values.size(); ++k) {
    if (!std::isfinite(one.values[k]) || (k > 0 && !(one.values[k] > one.values[k - 1])))
      return invalid(name, "values must be finite and ascending");
    if (!(one.probabilities[k] > 0.0)) return invalid(name, "probabilities must be greater than 0");
  }
  const double sum = std::accumulate(one.probabilities.begin(), one.probabilities.end(), 0.0);
  if (!(std::abs(sum - 1.0) < 1e-9))
    return invalid(name, fmt::format("the sum of the probabilities is {:g}, must be 1", sum));
  return {};
}

/// Discrete Stieltjes procedure with values of the polynomials at the support, normalized, and at
/// the points \cite gautschi2004.
std::vector<std::vector<double>> discrete_polynomials(const Distribution& one, int degree,
                                                      const std::vector<double>& points) {
  LEFORT_CHECK(std::size_t(degree) < one.values.size());
  std::vector<double> at_support(one.values.size(), 1.0), before(one.values.size(), 0.0);
  std::vector<std::vector<double>> rows(points.size(), {1.0});
  double norm_before = 0.0;
  for (int n = 0; n < degree; ++n) {
    double center = 0.0;  // Mean of x p_n^2.
    for (std::size_t k = 0; k < one.values.size(); ++k)
      center += one.probabilities[k] * one.values[k] * at_support[k] * at_support[k];
    std::vector<double> next(one.values.size());
    double norm2 = 0.0;
    for (std::size_t k = 0; k < next.size(); ++k) {
      next[k] = (one.values[k] - center) * at_support[k] - norm_before * before[k];
      norm2 += one.probabilities[k] * next[k] * next[k];
    }
    const double norm = std::sqrt(norm2);
    for (double& value : next) value /= norm;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double last = rows[i][std::size_t(n)];
      const double earlier = n > 0 ? rows[i][std::size_t(n) - 1] : 0.0;
      rows[i].push_back(((points[i] - center) * last - norm_before * earlier) / norm);
    }
    before = std::exchange(at_support, std::move(next));
    norm_before = norm;
  }
  return rows;
}

}  // namespace

std::string_view name_of(DistributionKind kind) {
  switch (kind) {
    case DistributionKind::kTruncatedNormal:
      return "truncated normal";
    case DistributionKind::kUniform:
      return "uniform";
    case DistributionKind::kLogNormal:
      return "lognormal";
    case DistributionKind::kTriangular:
      return "triangular";
    case DistributionKind::kDiscrete:
      return "discrete";
    default:
      return "normal";
  }
}

Result<void> check_distribution(const Distribution& one, const std::string& name) {
  const bool has_mean = one.kind == DistributionKind::kNormal ||
                        one.kind == DistributionKind::kTruncatedNormal ||
                        one.kind == DistributionKind::kLogNormal;
  const bool has_range = one.kind == DistributionKind::kUniform ||
                         one.kind == DistributionKind::kTriangular ||
                         one.kind == DistributionKind::kTruncatedNormal;
  if (one.kind == DistributionKind::kDiscrete) return check_discrete(one, name);
  if (has_mean && !std::isfinite(one.mean)) return invalid(name, "the mean must be finite");
  if (has_mean && !(one.standard_deviation > 0.0 && std::isfinite(one.standard_deviation)))
    return invalid(name, fmt::format("the standard deviation is {:g}, must be greater than 0",
                                     one.standard_deviation));
  if (one.kind == DistributionKind::kLogNormal && !(one.mean > 0.0))
    return invalid(name, fmt::format("the mean of a lognormal distribution is {:g}, must be "
                                     "greater than 0",
                                     one.mean));
  if (has_range && !(std::isfinite(one.low) && std::isfinite(one.high) && one.low < one.high))
    return invalid(name, fmt::format("low is {:g} and high is {:g}, low must be less than high",
                                     one.low, one.high));
  if (one.kind == DistributionKind::kTriangular && !(one.low <= one.mode && one.mode <= one.high))
    return invalid(name, fmt::format("the mode is {:g}, must be from {:g} to {:g}", one.mode,
                                     one.low, one.high));
  // Beyond eight standard deviations the truncated density has no significant digits.
  constexpr double kFarthest = 8.0;
  if (one.kind == DistributionKind::kTruncatedNormal &&
      (one.low > one.mean + kFarthest * one.standard_deviation ||
       one.high < one.mean - kFarthest * one.standard_deviation))
    return invalid(name, fmt::format("the range {:g} to {:g} is more than {:g} standard deviations "
                                     "from the mean {:g}",
                                     one.low, one.high, kFarthest, one.mean));
  return {};
}

Moments moments_of(const Distribution& one) {
  if (one.kind != DistributionKind::kDiscrete) {
    const OT::Distribution known = continuous(one);
    return {known.getMean()[0], known.getCovariance()(0, 0)};
  }
  Moments moments;
  for (std::size_t k = 0; k < one.values.size(); ++k)
    moments.mean += one.probabilities[k] * one.values[k];
  for (std::size_t k = 0; k < one.values.size(); ++k)
    moments.variance +=
        one.probabilities[k] * (one.values[k] - moments.mean) * (one.values[k] - moments.mean);
  return moments;
}

double quantile(const Distribution& one, double probability) {
  return quantiles(one, {probability}).front();
}

std::vector<double> quantiles(const Distribution& one, const std::vector<double>& probabilities) {
  std::vector<double> found(probabilities.size());
  if (one.kind != DistributionKind::kDiscrete) {
    const OT::Distribution known = continuous(one);
    for (std::size_t i = 0; i < found.size(); ++i)
      found[i] = known.computeQuantile(probabilities[i])[0];
    return found;
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::size_t k = 0;
    double sum = one.probabilities.front();
    while (probabilities[i] > sum && k + 1 < one.values.size()) sum += one.probabilities[++k];
    found[i] = one.values[k];
  }
  return found;
}

Distribution gauss_levels(const Distribution& distribution, int levels) {
  LEFORT_CHECK(distribution.kind != DistributionKind::kDiscrete && levels >= 2 && levels <= 9);
  const OT::Distribution known = continuous(distribution);
  const OT::Distribution standard = known.getStandardRepresentative();
  const OT::StandardDistributionPolynomialFactory family(standard);
  OT::Point weights;
  const OT::Point nodes = family.getNodesAndWeights(OT::UnsignedInteger(levels), weights);
  const double scale = std::sqrt(known.getCovariance()(0, 0) / standard.getCovariance()(0, 0));
  std::vector<std::pair<double, double>> pairs;
  for (OT::UnsignedInteger k = 0; k < nodes.getSize(); ++k)
    pairs.emplace_back(known.getMean()[0] + scale * (nodes[k] - standard.getMean()[0]), weights[k]);
  std::sort(pairs.begin(), pairs.end());
  Distribution discrete{.kind = DistributionKind::kDiscrete};
  for (const auto& [value, probability] : pairs) {
    discrete.values.push_back(value);
    discrete.probabilities.push_back(probability);
  }
  return discrete;
}

std::vector<std::vector<double>> orthonormal_polynomials(const Distribution& distribution,
                                                         int degree,
                                                         const std::vector<double>& points) {
  LEFORT_CHECK(degree >= 0 && degree <= 20);
  if (distribution.kind == DistributionKind::kDiscrete)
    return discrete_polynomials(distribution, degree, points);
  const OT::Distribution known = continuous(distribution);
  const OT::Distribution standard = known.getStandardRepresentative();
  const OT::StandardDistributionPolynomialFactory family(standard);
  std::vector<OT::OrthogonalUniVariatePolynomial> polynomials;
  for (int n = 0; n <= degree; ++n) polynomials.push_back(family.build(OT::UnsignedInteger(n)));
  const double scale = std::sqrt(standard.getCovariance()(0, 0) / known.getCovariance()(0, 0));
  std::vector<std::vector<double>> rows(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = standard.getMean()[0] + scale * (points[i] - known.getMean()[0]);
    for (const OT::OrthogonalUniVariatePolynomial& polynomial : polynomials)
      rows[i].push_back(polynomial(x));
  }
  return rows;
}

}  // namespace lefort::uncertainty
