/// \file
/// A matrix with one or two families of dispersed fibers, a shear part for Split.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

#include <array>

namespace lefort::fem {

/// Psi(F) = mu/2 (I1 - 3) + sum over families of k1/(2 k2) (exp(k2 <e>^2) - 1),
///   e = d (I1 - 3) + (1 - 3 d) (a . C a - 1),   <e> = e where e > 0, else 0.
///
/// All in C = J^(-2/3) F^T F, as in \cite gasser2006; d is their dispersion kappa: 0 for parallel
/// fibers, 1/3 for none preferred. Fibers bear tension only: a family that is shortened on the mean
/// (e <= 0) is slack. There the stress is continuous, the tangent is not; at F = I it is the
/// matrix's. For small strains the shear modulus is mu, and stretching along a lone family with
/// d = 0 is resisted by 4 k1 more. Every function needs J > 0.
/// \note a . C a is not the square of the fiber's own stretch where volume changes. Meant for a
/// bulk modulus much larger than mu and k1; \cite nolan2014 tell what goes wrong otherwise.
/// \note Where the exponential overflows, energy and stress are infinite or NaN, which solvers take
/// for inadmissible.
struct HolzapfelGasserOgden {
  double mu_mpa = 0.0;      ///< Shear modulus of the matrix, > 0.
  double k1_mpa = 0.0;      ///< Stiffness of the fibers, >= 0.
  double k2 = 0.0;          ///< How fast they stiffen, > 0.
  double dispersion = 0.0;  ///< In [0, 1/3].
  int family_count = 1;     ///< 1 or 2.
  /// Mean direction of each family at rest, a unit vector in L; its sign is of no account.
  std::array<Vec3, 2> fiber = {Vec3::UnitX(), Vec3::UnitY()};

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// Psi [MPa = mJ/mm^3]. Zero for F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric; order of entries as Mat9 says.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
