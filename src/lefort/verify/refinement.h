/// \file
/// Estimates the error on the finest of three meshes whose element size halves from one to the
/// next. The tolerance of a comparison with a known value is then derived from the values
/// themselves.
///
/// With v(h) = limit + C h^p the values v0, v1, v2 on meshes of sizes h, h/2, h/4 give
/// p = log2((v1 - v0) / (v2 - v1)). The error of v2 is |v2 - v1| / (2^p - 1). Roache's grid
/// convergence index (\cite roache1994) is this error times a factor of safety, 1.25 if p was
/// measured (\cite celik2008). If the values alternate there is no order; the larger of the two
/// differences is then used as the error.
///
/// A number that sums errors of both signs has no reliable order, because the errors may cancel.
/// The order must then be measured in a norm.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace lefort::verify {

/// Factor of safety of the grid convergence index for an order measured on three meshes.
inline constexpr double kRefinementSafety = 1.25;

struct Refinement {
  double order = NAN;  ///< Measured; NaN if values alternate.
  double error = NAN;  ///< Predicted, of the last value, >= 0, with the factor of safety; NaN if
                       ///< differences do not decrease.
};

/// \param values          on meshes whose element size halves, coarse to fine.
/// \param expected_order  > 0; the error is computed with at most this order.
[[nodiscard]] inline Refinement refinement_of(const std::array<double, 3>& values,
                                              double expected_order) {
  const double before = values[1] - values[0];
  const double last = values[2] - values[1];
  if (before * last < 0.0)
    return {.order = NAN, .error = kRefinementSafety * std::max(std::abs(before), std::abs(last))};
  const double order = std::log2(before / last);
  const double ratio = std::exp2(std::min(order, expected_order)) - 1.0;
  return {.order = order, .error = ratio > 0.0 ? kRefinementSafety * std::abs(last) / ratio : NAN};
}

/// Error of the last value, >= 0, with the factor of safety, for a given order. It is computed from
/// the last difference, or, if that is larger, from the last difference that the one before
/// predicts.
///
/// \param values  on meshes whose element size halves, coarse to fine.
/// \param order   measured elsewhere.
/// \returns the error; NaN unless order > 0.
[[nodiscard]] inline double predicted_error(const std::array<double, 3>& values, double order) {
  if (!(order > 0.0)) return NAN;
  const double before = std::abs(values[1] - values[0]);
  const double last = std::abs(values[2] - values[1]);
  return kRefinementSafety * std::max(last, before / std::exp2(order)) / (std::exp2(order) - 1.0);
}

}  // namespace lefort::verify
