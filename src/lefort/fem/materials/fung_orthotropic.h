/// \file
/// Fung's exponential law with three material axes, a shear part for Split.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// Psi(F) = c/2 (e^Q - 1),   c Q = sum over axes a of 2 mu_a (E^2)_aa + sum over a, b of
/// lambda_ab E_aa E_bb,   E = (J^(-2/3) F^T F - I) / 2, its entries taken along the axes.
///
/// \cite fung1993, chapter 7, in the constants of \cite ateshian2009, isochoric, as FEBio's and
/// ArtiSynth's law of this name. For small strains Hooke's orthotropic law: shear moduli
/// (mu_a + mu_b) / 2 in the planes of the axes; with equal mu and lambda an isotropic one of shear
/// modulus mu. Every function needs J > 0.
/// \note Where e^Q overflows, energy and stress are infinite or NaN, which solvers take for
/// inadmissible.
struct FungOrthotropic {
  Vec3 mu_mpa = Vec3::Zero();      ///< Each > 0.
  Mat3 lambda_mpa = Mat3::Zero();  ///< Symmetric; with 2 mu on the diagonal positive definite.
  double c_mpa = 0.0;              ///< > 0; the smaller, the sooner tissue stiffens.
  Mat3 axes = Mat3::Identity();    ///< The material axes at rest are its columns; orthonormal.

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
