/// \file
/// What a law answers at one F: all of it, or what is left of it when the element sees to the
/// volume.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/materials/material.h>

namespace lefort::fem {

enum class LawPart {
  kWhole,
  kIsochoric  ///< Of a law in split form (materials/decoupled_law.h) its shear part; of others all.
};

/// U(J) of a law in split form; null for others. Points into `material`.
[[nodiscard]] const Volumetric* volumetric_part(const Material& material);

/// A law in split form with another bulk modulus, >= 0; others as they are.
[[nodiscard]] Material with_bulk_modulus(Material material, double kappa_mpa);

/// Psi [MPa = mJ/mm^3]. \pre det F > 0, here and below.
[[nodiscard]] double energy(const Material& material, LawPart part, const Mat3& F);

/// P = dPsi/dF [MPa].
[[nodiscard]] Mat3 stress(const Material& material, LawPart part, const Mat3& F);

/// dP/dF [MPa].
[[nodiscard]] Mat9 tangent(const Material& material, LawPart part, const Mat3& F);

/// The shear modulus at rest [MPa]; of a law that is not isotropic the mean over the planes of the
/// axes.
[[nodiscard]] double shear_modulus_at_rest(const Material& material);

}  // namespace lefort::fem
