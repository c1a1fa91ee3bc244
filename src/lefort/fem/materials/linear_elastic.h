/// \file
/// Hooke's law, for comparison at small strain.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = mu eps : eps + lambda/2 (tr eps)^2,   eps = (F + F^T)/2 - I.
///
/// Linear in F: a large rotation causes strain and stress. For small rotations only.
struct LinearElastic {
  double mu_mpa = 0.0;      ///< Shear modulus, > 0.
  double lambda_mpa = 0.0;  ///< Lame's first constant, > -2/3 mu.

  /// \param young_mpa  E > 0.
  /// \param poisson    -1 < nu < 0.5.
  /// \returns the law, or kInvalidArgument.
  [[nodiscard]] static Result<LinearElastic> from_young_poisson(double young_mpa, double poisson);

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// Psi [MPa = mJ/mm^3]. Zero at F = I.
  [[nodiscard]] double energy(const Mat3& F) const;

  /// P = dPsi/dF [MPa]; to first order the Cauchy stress.
  [[nodiscard]] Mat3 stress(const Mat3& F) const;

  /// dP/dF [MPa], symmetric and constant; entries ordered as in Mat9.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const;
};

}  // namespace lefort::fem
