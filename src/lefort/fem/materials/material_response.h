/// \file
/// Energy, stress and tangent of any law at one F, of the whole law or of its isochoric part.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/materials/material.h>

namespace lefort::fem {

/// Part of a law.
enum class LawPart {
  kWhole,
  kIsochoric  ///< Isochoric part of a decoupled law (decoupled_law.h); the whole of others.
};

/// \returns U(J) of a decoupled law, null for others. Points into `material`.
[[nodiscard]] const Volumetric* volumetric_part(const Material& material);

/// \returns a decoupled law with another bulk modulus, >= 0; others unchanged.
[[nodiscard]] Material with_bulk_modulus(Material material, double kappa_mpa);

/// Psi [MPa = mJ/mm^3]. \pre det F > 0, here and below.
[[nodiscard]] double energy(const Material& material, LawPart part, const Mat3& F);

/// P = dPsi/dF [MPa].
[[nodiscard]] Mat3 stress(const Material& material, LawPart part, const Mat3& F);

/// dP/dF [MPa].
[[nodiscard]] Mat9 tangent(const Material& material, LawPart part, const Mat3& F);

/// \returns the shear modulus in the reference configuration [MPa]; for an anisotropic law the mean
///   over the three coordinate planes.
[[nodiscard]] double shear_modulus_at_rest(const Material& material);

}  // namespace lefort::fem
