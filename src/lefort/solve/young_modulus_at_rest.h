/// \file
/// Stiffness of a law at small strain, a reference for penalties and tolerances.
#pragma once

#include <lefort/fem/materials/material.h>

namespace lefort::solve {

/// Young's modulus of the isotropic law closest to the tangent at rest [MPa].
[[nodiscard]] double young_modulus_at_rest_mpa(const fem::Material& material);

}  // namespace lefort::solve
