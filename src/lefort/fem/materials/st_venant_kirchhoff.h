/// \file
/// The St Venant-Kirchhoff law: Hooke's law in the Green strain.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = mu E : E + lambda/2 (tr E)^2,   E = (F^T F - I) / 2.
///
/// \cite holzapfel2000, section 6.5. Hooke's law with Lame's constants mu and lambda at small
/// strain and any rotation. Not for large compression: compressed below 1/sqrt(3) of its length at
/// constant cross-section, a body softens, and a finite force compresses it to J = 0.
struct StVenantKirchhoff {
  double mu_mpa = 0.0;      ///< Shear modulus, > 0.
  double lambda_mpa = 0.0;  ///< Lame's first constant, > -2/3 mu.

  /// \param young_mpa  E > 0.
  /// \param poisson    -1 < nu < 0.5.
  /// \returns the law, or kInvalidArgument.
  [[nodiscard]] static Result<StVenantKirchhoff> from_young_poisson(double young_mpa,
                                                                    double poisson);

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// Psi [MPa = mJ/mm^3]. Zero at F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; entries ordered as in Mat9.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
