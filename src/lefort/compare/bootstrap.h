/// \file
/// Bootstrap intervals over the cases of a cohort.
#pragma once

#include <lefort/core/types.h>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lefort::compare {

/// A confidence interval.
struct Interval {
  double low;
  double high;
};

struct BootstrapOptions {
  int replicates = 2000;   ///< >= 1.
  double level = 0.95;     ///< Confidence level, 0 to 1.
  std::uint64_t seed = 1;  ///< Of the resampling: the same seed gives the same interval.
};

/// Draws cases with replacement.
///
/// \param cases    number of cases, >= 1.
/// \param options  number of replicates and seed.
/// \returns for each replicate the numbers of the `cases` drawn cases.
[[nodiscard]] std::vector<std::vector<Index>> bootstrap_samples(Index cases,
                                                                const BootstrapOptions& options);

/// Percentile interval of the replicates of a statistic \cite efron1993, section 13.3.
///
/// \param replicates  of the statistic; NaN are ignored.
/// \param level       confidence level, 0 to 1.
/// \returns the percentiles at (1 - level) / 2 and (1 + level) / 2, interpolated linearly between
///   order statistics; NaN if there are no values.
[[nodiscard]] Interval percentile_interval(std::span<const double> replicates, double level);

/// Bootstrap interval of a statistic of a cohort. Cases are independent, points of one face are
/// not: only whole cases are drawn.
///
/// \param cases      number of cases.
/// \param statistic  of the cases with the given numbers.
/// \param options    replicates, level and seed.
/// \returns the percentile interval; NaN for fewer than two cases.
[[nodiscard]] Interval bootstrap_interval(
    Index cases, const std::function<double(std::span<const Index>)>& statistic,
    const BootstrapOptions& options = {});

}  // namespace lefort::compare
