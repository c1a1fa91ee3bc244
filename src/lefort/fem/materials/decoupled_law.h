/// \file
/// Decoupled laws for nearly incompressible tissue: an isochoric plus a volumetric energy.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/materials/volumetric.h>

namespace lefort::fem {

/// Psi(F) = Psi_iso(F) + U(J), where Psi_iso depends on J^(-1/3) F only.
///
/// \cite bonet2008, section 6.5; \cite holzapfel2000, section 6.4. Elements that must not lock
/// evaluate `isochoric` at F and `volume` at an averaged J. At small strain an isotropic law is
/// Hooke's law with the bulk modulus volume.kappa_mpa and the shear modulus of `isochoric`. With
/// kappa of the order of the shear modulus the law is compressible. Every function requires J > 0.
///
/// \tparam Isochoric  an isochoric law: energy(F), stress(F), tangent(F), validate().
template <class Isochoric>
struct DecoupledLaw {
  Isochoric isochoric = {};
  Volumetric volume = {};

  /// \returns kInvalidArgument if a constant of either part lies outside its range.
  [[nodiscard]] Result<void> validate() const {
    LEFORT_TRY_VOID(isochoric.validate());
    return volume.validate();
  }

  /// Psi [MPa = mJ/mm^3]. Zero at F = I.
  [[nodiscard]] double energy(const Mat3& F) const {
    return isochoric.energy(F) + volume.energy_minus_one(jacobian_minus_one(F));
  }

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const {
    return isochoric.stress(F) + volume.dU_dJ(volume_ratio(F)) * cofactor(F);
  }

  /// dP/dF [MPa], symmetric; entries ordered as in Mat9.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const {
    const double J = volume_ratio(F);
    const Vec9 slope_of_J = flatten(cofactor(F));
    Mat9 A = isochoric.tangent(F);
    A.noalias() += volume.d2U_dJ2(J) * slope_of_J * slope_of_J.transpose();
    A += volume.dU_dJ(J) * cofactor_tangent(F);
    return A;
  }
};

/// Whether a law is decoupled.
template <class Law>
inline constexpr bool kIsDecoupled = false;
template <class Isochoric>
inline constexpr bool kIsDecoupled<DecoupledLaw<Isochoric>> = true;

}  // namespace lefort::fem
