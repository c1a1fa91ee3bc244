/// \file
/// The compressible neo-Hookean law.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2,   I1 = tr(F^T F),   J = det F.
///
/// \cite bonet2008, section 6.4.3. At small strain this is Hooke's law with Lame's constants mu
/// and lambda. Every function requires J > 0.
struct NeoHookean {
  double mu_mpa = 0.0;      ///< Shear modulus, > 0.
  double lambda_mpa = 0.0;  ///< Lame's first constant, >= 0.

  /// \param young_mpa  E > 0.
  /// \param poisson    0 <= nu < 0.5.
  /// \returns the law, or kInvalidArgument.
  [[nodiscard]] static Result<NeoHookean> from_young_poisson(double young_mpa, double poisson);

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
