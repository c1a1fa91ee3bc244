/// \file
/// Parts of the volumetric energy of elements with a continuous pressure.
#pragma once

#include <lefort/core/check.h>
#include <lefort/fem/materials/material_response.h>

#include <algorithm>

namespace lefort::fem {

/// Bulk modulus that stays at the quadrature points [MPa]. Linear elasticity with a pressure,
/// sigma = 2 mu eps + p I and p = lambda div u, has 2/3 mu there (\cite boffi2013; \cite
/// malkus1978), because lambda = kappa - 2/3 mu.
///
/// \pre the law is decoupled.
[[nodiscard]] inline double bulk_modulus_at_points_mpa(const Material& material) {
  return std::min(volumetric_part(material)->kappa_mpa,
                  2.0 / 3.0 * shear_modulus_at_rest(material));
}

/// \returns the part of a decoupled law that stays at the quadrature points; other laws unchanged.
[[nodiscard]] inline Material law_at_points(const Material& material) {
  if (volumetric_part(material) == nullptr) return material;
  return with_bulk_modulus(material, bulk_modulus_at_points_mpa(material));
}

/// \returns U of the rest, which the pressure carries. \pre the law is decoupled.
[[nodiscard]] inline Volumetric volumetric_of_pressure(const Material& material) {
  const Volumetric* whole = volumetric_part(material);
  LEFORT_CHECK(whole != nullptr);
  Volumetric rest = *whole;
  rest.kappa_mpa -= bulk_modulus_at_points_mpa(material);
  return rest;
}

}  // namespace lefort::fem
