/// \file
/// Nearly incompressible laws: what a change of shape costs, plus what a change of volume costs.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/materials/volumetric.h>

namespace lefort::fem {

/// Psi(F) = isochoric(F) + U(J), where isochoric(F) depends on F through J^(-1/3) F alone.
///
/// \cite bonet2008, section 6.5. Elements that must not lock take `shear` at the points' F and
/// `volume` at a volume ratio of their own. For small strains Hooke's law with the bulk modulus
/// volume.kappa_mpa and the shear modulus of `shear`; with kappa of the order of that modulus the
/// law is a compressible one. Every function needs J > 0.
///
/// \tparam Shear  an isochoric law: energy(F), stress(F), tangent(F), validate().
template <class Isochoric>
struct DecoupledLaw {
  Isochoric isochoric = {};
  Volumetric volume = {};

  /// \returns kInvalidArgument if a constant of either part lies outside its range.
  [[nodiscard]] Result<void> validate() const {
    LEFORT_TRY_VOID(isochoric.validate());
    return volume.validate();
  }

  /// Psi [MPa = mJ/mm^3]. Zero for F = I.
  [[nodiscard]] double energy(const Mat3& F) const {
    return isochoric.energy(F) + volume.energy_minus_one(jacobian_minus_one(F));
  }

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const {
    return isochoric.stress(F) + volume.dU_dJ(volume_ratio(F)) * cofactor(F);
  }

  /// dP/dF [MPa], symmetric; order of entries as Mat9 says.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const {
    const double J = volume_ratio(F);
    const Vec9 slope_of_J = flatten(cofactor(F));
    Mat9 A = isochoric.tangent(F);
    A.noalias() += volume.d2U_dJ2(J) * slope_of_J * slope_of_J.transpose();
    A += volume.dU_dJ(J) * cofactor_tangent(F);
    return A;
  }
};

/// Whether a law is isochoric(F) + U(J), so that elements may treat both apart.
template <class Law>
inline constexpr bool kIsDecoupled = false;
template <class Isochoric>
inline constexpr bool kIsDecoupled<DecoupledLaw<Isochoric>> = true;

}  // namespace lefort::fem
