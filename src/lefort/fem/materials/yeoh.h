/// \file
/// Yeoh's law, a shear part for Split.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = c10 x + c20 x^2 + c30 x^3,   x = J^(-2/3) I1 - 3.
///
/// \cite yeoh1993. For small strains the shear modulus is 2 c10; tissue stiffens by c20 and c30.
/// With c30 = 0 also called the reduced polynomial of second order. Every function needs J > 0.
struct Yeoh {
  double c10_mpa = 0.0;  ///< > 0.
  double c20_mpa = 0.0;  ///< May be negative, while c20^2 < 3 c10 c30: dPsi/dx stays positive.
  double c30_mpa = 0.0;  ///< >= 0.

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// At small strain [MPa].
  [[nodiscard]] double shear_modulus_mpa() const { return 2.0 * c10_mpa; }

  /// Psi [MPa = mJ/mm^3]. Zero for F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; order of entries as Mat9 says.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
