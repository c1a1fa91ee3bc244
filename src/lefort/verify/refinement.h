/// \file
/// What three meshes that halve tell of the finest one's error: the tolerance of a comparison with
/// a known value must come from the values themselves.
///
/// With v(h) = limit + C h^p the values v0, v1, v2 on meshes of sizes h, h/2, h/4 give
/// p = log2((v1 - v0) / (v2 - v1)), and of v2 the error |v2 - v1| / (2^p - 1). Roache's grid
/// convergence index takes 1.25 times that where p was measured (\cite roache1994). Where the
/// values go to and fro there is no order; their spread takes the error's place.
///
/// A number in which errors of both signs meet follows no power: where they cancel, it is right by
/// chance. Its order is then that of a norm, which vanishes with the error alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace lefort::verify {

/// Roache's factor of safety for an order measured on three meshes.
inline constexpr double kRefinementSafety = 1.25;

struct Refinement {
  double order = NAN;  ///< Measured; NaN where values go to and fro.
  double error = NAN;  ///< Predicted, of the last value, >= 0, with the factor of safety; NaN where
                       ///< differences do not fall.
};

/// \param values          from meshes that halve, coarse to fine.
/// \param expected_order  > 0: a measured one above it, which is chance, predicts no smaller error.
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

/// The error of the last value, >= 0, with the factor of safety, by an order that was measured
/// elsewhere: by the larger of the last difference and of what the one before makes expect.
/// \param order  NaN unless > 0.
[[nodiscard]] inline double predicted_error(const std::array<double, 3>& values, double order) {
  if (!(order > 0.0)) return NAN;
  const double before = std::abs(values[1] - values[0]);
  const double last = std::abs(values[2] - values[1]);
  return kRefinementSafety * std::max(last, before / std::exp2(order)) / (std::exp2(order) - 1.0);
}

}  // namespace lefort::verify
