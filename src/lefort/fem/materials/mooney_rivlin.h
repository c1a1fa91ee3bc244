/// \file
/// The Mooney-Rivlin law, isochoric (for DecoupledLaw).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3),   I2 = ((tr C)^2 - tr C^2) / 2.
///
/// \cite holzapfel2000, section 6.5. At small strain the shear modulus is 2 (c10 + c01). Every
/// function requires J > 0.
struct MooneyRivlin {
  /// >= 0, and c10 + c01 > 0. With a negative constant the energy is unbounded below.
  double c10_mpa = 0.0;
  double c01_mpa = 0.0;  ///< >= 0.

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// At small strain [MPa].
  [[nodiscard]] double shear_modulus_mpa() const { return 2.0 * (c10_mpa + c01_mpa); }

  /// Psi [MPa = mJ/mm^3]. Zero at F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; entries ordered as in Mat9.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
