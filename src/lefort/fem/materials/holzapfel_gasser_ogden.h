/// \file
/// A matrix with one or two families of dispersed fibers, isochoric (for DecoupledLaw).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

#include <array>

namespace lefort::fem {

/// Psi(F) = mu/2 (I1 - 3) + sum over families of k1/(2 k2) (exp(k2 <e>^2) - 1),
///   e = d (I1 - 3) + (1 - 3 d) (a . C a - 1),   <e> = max(e, 0).
///
/// C = J^(-2/3) F^T F and I1 = tr C, as in \cite gasser2006; a is the direction of a family and d
/// the dispersion, called kappa there: 0 for parallel fibers, 1/3 for an isotropic distribution.
/// Fibers have no stiffness in compression: a family with e <= 0 is slack. At e = 0 the stress is
/// continuous but the tangent is not; at F = I the tangent is that of the matrix. At small strain
/// the shear modulus is mu; a single taut family with d = 0 adds the stiffness 4 k1 along the
/// fibers. Every function requires J > 0.
/// \note a . C a is not the squared stretch of a fiber if the volume changes. The law is meant for
/// a bulk modulus much larger than mu and k1; \cite nolan2014 describe the error otherwise.
/// \note If the exponential overflows, energy and stress are infinite or NaN, which solvers treat
/// as inadmissible.
struct HolzapfelGasserOgden {
  double mu_mpa = 0.0;      ///< Shear modulus of the matrix, > 0.
  double k1_mpa = 0.0;      ///< Stiffness of the fibers, >= 0.
  double k2 = 0.0;          ///< Exponent of the fibers, > 0.
  double dispersion = 0.0;  ///< In [0, 1/3].
  int family_count = 1;     ///< 1 or 2.
  /// Mean direction of each family in the reference configuration, a unit vector in L of any sign.
  std::array<Vec3, 2> fiber = {Vec3::UnitX(), Vec3::UnitY()};

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
