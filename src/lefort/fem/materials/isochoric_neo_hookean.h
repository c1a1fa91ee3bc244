/// \file
/// The neo-Hookean law of change of shape alone, a shear part for Split.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = mu/2 (J^(-2/3) I1 - 3),   I1 = tr(F^T F),   J = det F.
///
/// \cite bonet2008, section 6.5. For small strains the shear modulus is mu. Every function needs
/// J > 0.
struct IsochoricNeoHookean {
  double mu_mpa = 0.0;  ///< Shear modulus, > 0.

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// At small strain [MPa].
  [[nodiscard]] double shear_modulus_mpa() const { return mu_mpa; }

  /// Psi [MPa = mJ/mm^3]. Zero for F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; order of entries as Mat9 says.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
