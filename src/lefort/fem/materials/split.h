/// \file
/// Nearly incompressible laws: what a change of shape costs, plus what a change of volume costs.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/materials/volumetric.h>

namespace lefort::fem {

/// Psi(F) = shear(F) + U(J), where shear(F) depends on F through J^(-1/3) F alone.
///
/// \cite bonet2008, section 6.5. Elements that must not lock take `shear` at the points' F and
/// `volume` at a volume ratio of their own. For small strains Hooke's law with the bulk modulus
/// volume.kappa_mpa and the shear modulus of `shear`; with kappa of the order of that modulus the
/// law is a compressible one. Every function needs J > 0.
///
/// \tparam Shear  an isochoric law: energy(F), stress(F), tangent(F), validate().
template <class Shear>
struct Split {
  Shear shear = {};
  Volumetric volume = {};

  /// \returns kInvalidArgument if a constant of either part lies outside its range.
  [[nodiscard]] Result<void> validate() const {
    LEFORT_TRY_VOID(shear.validate());
    return volume.validate();
  }

  /// Psi [MPa = mJ/mm^3]. Zero for F = I.
  [[nodiscard]] double energy(const Mat3& F) const {
    return shear.energy(F) + volume.energy_of_change(volume_change(F));
  }

  /// P = dPsi/dF, first Piola-Kirchhoff [MPa].
  [[nodiscard]] Mat3 stress(const Mat3& F) const {
    return shear.stress(F) + volume.slope(volume_ratio(F)) * cofactor(F);
  }

  /// dP/dF [MPa], symmetric; order of entries as Mat9 says.
  [[nodiscard]] Mat9 tangent(const Mat3& F) const {
    const double J = volume_ratio(F);
    const Vec9 slope_of_J = flatten(cofactor(F));
    Mat9 A = shear.tangent(F);
    A.noalias() += volume.curvature(J) * slope_of_J * slope_of_J.transpose();
    A += volume.slope(J) * cofactor_tangent(F);
    return A;
  }
};

/// Whether a law is shear(F) + U(J), so that elements may treat both apart.
template <class Law>
inline constexpr bool kIsSplit = false;
template <class Shear>
inline constexpr bool kIsSplit<Split<Shear>> = true;

}  // namespace lefort::fem
