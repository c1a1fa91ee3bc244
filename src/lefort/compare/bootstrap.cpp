#include <lefort/compare/bootstrap.h>
#include <lefort/core/check.h>
#include <lefort/core/random_draws.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace lefort::compare {
namespace {

/// \pre `ascending` is not empty.
double quantile(const std::vector<double>& ascending, double fraction) {
  const double at = fraction * double(ascending.size() - 1);
  const auto below = std::size_t(at);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  const double t = at - double(below);
  return (1.0 - t) * ascending[below] + t * ascending[above];
}

}  // namespace

std::vector<std::vector<Index>> bootstrap_samples(Index cases, const BootstrapOptions& options) {
  LEFORT_CHECK(cases >= 1);
  LEFORT_CHECK(options.replicates >= 1);
  std::mt19937_64 bits(options.seed);
  std::vector<std::vector<Index>> samples(std::size_t(options.replicates));
  for (std::vector<Index>& sample : samples)
    for (Index k = 0; k < cases; ++k) sample.push_back(draw_below(bits, cases));
  return samples;
}

Interval percentile_interval(std::span<const double> replicates, double level) {
  std::vector<double> ascending;
  for (const double value : replicates)
    if (!std::isnan(value)) ascending.push_back(value);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (ascending.empty()) return {kNone, kNone};
  std::sort(ascending.begin(), ascending.end());
  return {quantile(ascending, 0.5 * (1.0 - level)), quantile(ascending, 0.5 * (1.0 + level))};
}

Interval bootstrap_interval(Index cases,
                            const std::function<double(std::span<const Index>)>& statistic,
                            const BootstrapOptions& options) {
  if (cases < 2) return percentile_interval({}, options.level);
  std::vector<double> replicates;
  for (const std::vector<Index>& sample : bootstrap_samples(cases, options))
    replicates.push_back(statistic(sample));
  return percentile_interval(replicates, options.level);
}

}  // namespace lefort::compare
