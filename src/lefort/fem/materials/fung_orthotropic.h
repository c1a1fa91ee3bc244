/// \file
/// Fung's exponential law with three material axes, isochoric (for DecoupledLaw).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = c/2 (e^Q - 1),
///   c Q = sum over axes a of 2 mu_a (E^2)_aa + sum over a, b of lambda_ab E_aa E_bb,
///   E = (J^(-2/3) F^T F - I) / 2, with components along the axes.
///
/// \cite fung1993, chapter 7, with the constants of \cite ateshian2009, isochoric, as the law of
/// this name in FEBio and ArtiSynth. At small strain it is Hooke's orthotropic law with the shear
/// moduli (mu_a + mu_b) / 2 in the planes of the axes; if all mu_a are equal and all lambda_ab are
/// equal, the law is isotropic with the shear modulus mu. Every function requires J > 0.
/// \note If e^Q overflows, energy and stress are infinite or NaN, which solvers treat as
/// inadmissible.
struct FungOrthotropic {
  Vec3 mu_mpa = Vec3::Zero();  ///< Each > 0.
  /// Symmetric; positive definite after 2 mu_a is added to each entry (a, a).
  Mat3 lambda_mpa = Mat3::Zero();
  double c_mpa = 0.0;  ///< > 0; with a smaller c, tissue stiffens at smaller strain.
  /// Columns: material axes in the reference configuration, in L, orthonormal.
  Mat3 axes = Mat3::Identity();

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
