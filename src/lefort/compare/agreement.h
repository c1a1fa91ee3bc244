/// \file
/// Agreement of two methods of measurement.
#pragma once

#include <lefort/compare/bootstrap.h>
#include <lefort/core/types.h>

#include <span>

namespace lefort::compare {

/// Limits of agreement \cite bland1986.
struct Agreement {
  Index pairs = 0;
  double bias = 0.0;                ///< Mean of first minus second; NaN without pairs.
  double standard_deviation = 0.0;  ///< Of the differences; NaN for fewer than two pairs.
  Interval limits{};                ///< bias -+ 1.96 standard deviations; NaN likewise.
};

/// \param first, second  measurements of the same quantity, one pair per case. \pre equal sizes.
/// \returns the agreement of the pairs without NaN.
[[nodiscard]] Agreement agreement_of(std::span<const double> first, std::span<const double> second);

}  // namespace lefort::compare
