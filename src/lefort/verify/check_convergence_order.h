/// \file
/// Compares a quantity, computed on meshes whose element size halves, with its reference: the order
/// of its error with that of theory, and its value on the finest mesh with the exact value. The
/// tolerance of the second comparison is the error that the order predicts.
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

/// Adds two checks: "NAME: order" and "NAME: difference over the predicted one". If the values
/// alternate they have no order; the first check is then "NAME: spread" (at most 1 %).
///
/// \param name     of the quantity.
/// \param values   three or more, coarse to fine; the last three count.
/// \param known    its reference.
/// \param section  to which the checks are added.
void check_convergence_order(const std::string& name, std::span<const double> values,
                             const Known& known, Section& section);

/// Adds only the second check. Its predicted error has an order that was measured in a norm
/// (predicted_error()).
///
/// \param name        of the quantity.
/// \param values      from three meshes, coarse to fine.
/// \param norm_order  the measured order.
/// \param known       its reference.
/// \param section     to which the check is added.
void check_difference(const std::string& name, const std::array<double, 3>& values,
                      double norm_order, const Known& known, Section& section);

/// Adds checks of errors with respect to an exact solution: "NAME: order of the error", from the
/// last two errors; with three or more also "NAME: error over the predicted one". The predicted
/// error on the finest mesh is 1.25 (Roache) times e / 2^p, where e is the error on the mesh before
/// and p the order between the two meshes before the finest, at most that of theory.
///
/// \param name     of the quantity.
/// \param errors   two or more, > 0, coarse to fine.
/// \param known    `value` and `allowance` are not used; `known_failure` is that of the order.
/// \param section  to which the checks are added.
void check_error_order(const std::string& name, std::span<const double> errors, const Known& known,
                       Section& section);

}  // namespace lefort::verify
