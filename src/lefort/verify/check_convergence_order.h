/// \file
/// Compares a quantity computed on meshes that halve with its reference: the order of its error
/// with theory, and its finest value with the exact one within the error that the order predicts.
#pragma once

#include <lefort/verify/check.h>

#include <array>
#include <span>
#include <string>

namespace lefort::verify {

/// Reference of a quantity.
struct Known {
  double value = 1.0;
  double order = 2.0;        ///< Of the error, in theory.
  double order_slack = 0.2;  ///< Accepted deficit of the measured order.
  std::string order_reason = "";
  double allowance = 0.0;  ///< Uncertainty of `value`, >= 0.
  std::string allowance_reason = "";
  std::string known_failure = "";  ///< Why both checks are known to fail; or empty.
};

/// Adds two checks: "NAME: order", or "NAME: spread" (at most 1 %) if the values alternate and have
/// no order, and "NAME: difference over the predicted one".
///
/// \param name     of the quantity.
/// \param values   three or more, coarse to fine; the last three count.
/// \param known    its reference.
/// \param section  to which the checks are added.
void check_convergence_order(const std::string& name, std::span<const double> values,
                             const Known& known, Section& section);

/// Adds only the second check, by an order measured in a norm (predicted_error()).
///
/// \param name        of the quantity.
/// \param values      from three meshes, coarse to fine.
/// \param norm_order  the measured order.
/// \param known       its reference.
/// \param section     to which the check is added.
void check_difference(const std::string& name, const std::array<double, 3>& values,
                      double norm_order, const Known& known, Section& section);

/// Adds checks of errors with respect to an exact solution: "NAME: order of the error", of the last
/// two; and for three or more, "NAME: error over the predicted one". The predicted error is the
/// last but one, reduced by the order between the two before the last (at most that of theory),
/// times Roache's 1.25.
///
/// \param name     of the quantity.
/// \param errors   two or more, > 0, coarse to fine.
/// \param known    `value` and `allowance` are not used; `known_failure` is that of the order.
/// \param section  to which the checks are added.
void check_error_order(const std::string& name, std::span<const double> errors, const Known& known,
                       Section& section);

}  // namespace lefort::verify
