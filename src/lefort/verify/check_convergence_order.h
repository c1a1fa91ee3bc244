/// \file
/// Holds a quantity, computed on meshes that halve, against what is known of it: the order of its
/// error against theory, its finest value against the truth within the error that the order
/// predicts.
#pragma once

#include <lefort/verify/check.h>

#include <array>
#include <span>
#include <string>

namespace lefort::verify {

/// What is known of a quantity.
struct Known {
  double value = 1.0;
  double order = 2.0;        ///< In theory.
  double order_slack = 0.2;  ///< By how much the measured one may fall short.
  std::string order_reason = "";
  double allowance = 0.0;  ///< By how much `value` may itself be wrong, >= 0.
  std::string allowance_reason = "";
  std::string known_failure = "";  ///< Why both checks are known to be missed; or empty.
};

/// Adds two checks: "NAME: order", or "NAME: spread" (at most 1 %) where the values go to and fro
/// and have none, and "NAME: difference over the predicted one".
/// \param values  three or more, coarse to fine; the last three count.
void check_convergence_order(const std::string& name, std::span<const double> values,
                             const Known& known, Section& section);

/// Adds the second check alone, by an order that was measured in a norm (predicted_error()).
/// \param values  from three meshes, coarse to fine.
void check_difference(const std::string& name, const std::array<double, 3>& values,
                      double norm_order, const Known& known, Section& section);

/// Adds checks of errors whose truth is known: "NAME: order of the error", of the last two; and,
/// from three on, "NAME: error over the predicted one": that of the last but one, less by the order
/// which the two before the last show (at most that in theory), times Roache's 1.25.
/// \param errors  two or more, > 0, coarse to fine.
/// \param known   `value` and `allowance` do not count; `miss` is the order's.
void check_error_order(const std::string& name, std::span<const double> errors, const Known& known,
                       Section& section);

}  // namespace lefort::verify
