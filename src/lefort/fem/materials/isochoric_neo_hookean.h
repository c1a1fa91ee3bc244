/// \file
/// The isochoric neo-Hookean law (for DecoupledLaw).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = mu/2 (J^(-2/3) I1 - 3),   I1 = tr(F^T F),   J = det F.
///
/// \cite bonet2008, section 6.5. At small strain the shear modulus is mu. Every function requires
/// J > 0.
struct IsochoricNeoHookean {
  double mu_mpa = 0.0;  ///< Shear modulus, > 0.

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// At small strain [MPa].
  [[nodiscard]] double shear_modulus_mpa() const { return mu_mpa; }

  /// Psi [MPa = mJ/mm^3]. Zero at F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; entries ordered as in Mat9.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
