/// \file
/// Holds a quantity, computed on meshes that halve, against what is known of it: the order of its
/// error against theory, its finest value against the truth within the error that the order
/// predicts.
#pragma once

#include <lefort/verify/check.h>

#include <span>
#include <string>

namespace lefort::verify {

/// What is known of a quantity.
struct Known {
  double value = 1.0;
  double order = 2.0;        ///< In theory.
  double order_slack = 0.2;  ///< By how much the measured one may fall short.
  std::string order_reason;
  double allowance = 0.0;  ///< By how much `value` may itself be wrong, >= 0.
  std::string allowance_reason = "";
  std::string miss = "";  ///< Why both checks are known to be missed; or empty.
};

/// Adds two checks: "NAME: order", or "NAME: spread" (at most 1 %) where the values go to and fro
/// and have none, and "NAME: difference over the predicted one".
/// \param values  three or more, coarse to fine; the last three count.
void judge_refinement(const std::string& name, std::span<const double> values, const Known& known,
                      Section& section);

}  // namespace lefort::verify
