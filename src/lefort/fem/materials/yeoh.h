/// \file
/// Yeoh's law, isochoric (for DecoupledLaw).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = c10 x + c20 x^2 + c30 x^3,   x = J^(-2/3) I1 - 3.
///
/// \cite yeoh1993. At small strain the shear modulus is 2 c10; positive c20 and c30 add stiffening.
/// With c30 = 0 it is the reduced polynomial of second order. Every function requires J > 0.
struct Yeoh {
  double c10_mpa = 0.0;  ///< > 0.
  double c20_mpa = 0.0;  ///< >= 0, or c20^2 < 3 c10 c30, so that dPsi/dx > 0.
  double c30_mpa = 0.0;  ///< >= 0.

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// At small strain [MPa].
  [[nodiscard]] double shear_modulus_mpa() const { return 2.0 * c10_mpa; }

  /// Psi [MPa = mJ/mm^3]. Zero at F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; entries ordered as in Mat9.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
