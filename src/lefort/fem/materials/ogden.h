/// \file
/// Ogden's law in principal stretches, isochoric (for DecoupledLaw).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

#include <array>

namespace lefort::fem {

/// One term: mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3).
struct OgdenTerm {
  double mu_mpa = 0.0;  ///< mu alpha > 0.
  double alpha = 0.0;   ///< Not 0, of either sign.
};

/// Psi(F) = sum of up to three terms mu_p/alpha_p (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3), where
/// l_i are the principal stretches of J^(-1/3) F.
///
/// \cite ogden1984, chapter 7; mu and alpha are those of \cite holzapfel2000, sections 6.5 and 6.6:
/// the shear modulus at small strain is 1/2 sum of mu_p alpha_p. With alpha = 2 and -2 it is
/// Mooney-Rivlin, c10 = mu_1/2 and c01 = -mu_2/2. Every function requires J > 0.
/// \note Accurate at equal and nearly equal stretches: the difference quotients of the tangent are
/// computed from differences of logarithms. Needs an eigendecomposition.
struct Ogden {
  /// Terms after the first are optional: unused ones have both constants zero.
  std::array<OgdenTerm, 3> terms = {};

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// At small strain [MPa].
  [[nodiscard]] double shear_modulus_mpa() const;

  /// Psi [MPa = mJ/mm^3]. Zero at F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; entries ordered as in Mat9.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
