/// \file
/// The Mooney-Rivlin law, a shear part for Split.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3),   I2 = ((tr C)^2 - tr C^2) / 2.
///
/// \cite holzapfel2000, section 6.5. For small strains the shear modulus is 2 (c10 + c01). Every
/// function needs J > 0.
struct MooneyRivlin {
  double c10_mpa = 0.0;  ///< >= 0, one of both > 0: a negative one lets the energy fall for ever.
  double c01_mpa = 0.0;  ///< >= 0.

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// At small strain [MPa].
  [[nodiscard]] double shear_modulus_mpa() const { return 2.0 * (c10_mpa + c01_mpa); }

  /// Psi [MPa = mJ/mm^3]. Zero for F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; order of entries as Mat9 says.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
