/// \file
/// Numbers of teeth that the user has corrected.
#pragma once

#include <lefort/core/error.h>
#include <lefort/dental/number_teeth.h>

#include <span>

namespace lefort::dental {

/// A corrected number.
struct ToothCorrection {
  int found = 0;  ///< By number_teeth().
  int fdi = 0;    ///< The number it has; 0 if it is no tooth.
};

/// \returns whether quadrant and position exist in the permanent dentition.
[[nodiscard]] constexpr bool is_fdi_number(int fdi) {
  return fdi / 10 >= 1 && fdi / 10 <= 4 && fdi % 10 >= 1 && fdi % 10 <= 8;
}

/// Corrects the numbers. All corrections apply at once, so that two numbers can be exchanged.
///
/// \param teeth        of number_teeth().
/// \param corrections  any.
/// \returns the teeth; or kInvalidArgument if no tooth was found with a number, a number is no FDI
///   number or of the other jaw, or two teeth would have the same one.
[[nodiscard]] Result<NumberedTeeth> renumbered(NumberedTeeth teeth,
                                               std::span<const ToothCorrection> corrections);

}  // namespace lefort::dental
