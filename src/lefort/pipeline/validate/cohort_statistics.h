/// \file
/// Statistics of a cohort from the results of its cases. Reads no file.
#pragma once

#include <lefort/compare/agreement.h>
#include <lefort/compare/bootstrap.h>
#include <lefort/core/types.h>
#include <lefort/pipeline/validate/case_result.h>

#include <array>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// Mean over cases with its bootstrap interval.
struct CohortValue {
  double mean;  ///< NaN without cases.
  compare::Interval interval;
};

struct CohortRegion {
  std::string region;
  Index cases = 0;  ///< With a comparison in this region.
  std::array<std::array<CohortValue, kStatistics.size()>, kMethods.size()> methods{};
  /// Mean error of the method minus that of the prediction, case by case; positive: the prediction
  /// is better. That of the prediction itself is 0.
  std::array<CohortValue, kMethods.size()> gain_mm{};
  /// Fractions of all cases, including those that failed, with a mean error of at most 1 mm, 2 mm.
  double cases_within_1mm_fraction = 0.0, cases_within_2mm_fraction = 0.0;
  /// Of the predicted and the achieved displacement of the skin along y.
  compare::Agreement agreement_y{};
};

/// \param values  of the cases; NaN are ignored.
/// \returns their mean, with its interval.
[[nodiscard]] CohortValue cohort_value(std::span<const double> values,
                                       const compare::BootstrapOptions& bootstrap = {});

/// \param results    of all cases.
/// \param bootstrap  of the intervals.
/// \returns the regions that occur, in the order of compare::reported_regions().
[[nodiscard]] std::vector<CohortRegion> cohort_statistics(
    std::span<const CaseResult> results, const compare::BootstrapOptions& bootstrap = {});

}  // namespace lefort::pipeline
