/// \file
/// Compares a quantity with its reference. The quantity is computed on meshes whose element size
/// halves from one to the next. The order of its error is compared with that of theory, and its
/// value on the finest mesh with the exact value. The tolerance of the second comparison is the
/// error that the order predicts.
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
  /// Why the checks of order and difference are known to fail, or empty; not applied to the check
  /// of the spread.
  std::string known_failure = "";
};

/// Adds two checks: "NAME: order" and "NAME: difference over the predicted one". If the values
/// alternate they have no order; the first check is then "NAME: spread of the last three meshes"
/// (at most 1 % of Known::value).
///
/// \param name     of the quantity.
/// \param values   three or more, coarse to fine; the last three are used.
/// \param known    its reference.
/// \param section  to which the checks are added.
void check_convergence_order(const std::string& name, std::span<const double> values,
                             const Known& known, Section& section);

/// Adds only the check of the difference. The order in its predicted error (predicted_error()) was
/// measured in a norm.
///
/// \param name        of the quantity.
/// \param values      from three meshes, coarse to fine.
/// \param norm_order  the measured order; at most `known.order` of it is used.
/// \param known       its reference.
/// \param section     to which the check is added.
void check_difference(const std::string& name, const std::array<double, 3>& values,
                      double norm_order, const Known& known, Section& section);

/// Adds checks of errors with respect to an exact solution: "NAME: order of the error", from the
/// last two errors; with three or more also "NAME: error over the predicted one". The predicted
/// error on the finest mesh is kRefinementSafety times e / 2^p, where e is the error on the mesh
/// before the finest and p the order between the two meshes before the finest, at most that of
/// theory.
///
/// \param name     of the quantity.
/// \param errors   two or more, > 0, coarse to fine.
/// \param known    `value` and `allowance` are not used; `known_failure` is that of the order.
/// \param section  to which the checks are added.
void check_error_order(const std::string& name, std::span<const double> errors, const Known& known,
                       Section& section);

}  // namespace lefort::verify
