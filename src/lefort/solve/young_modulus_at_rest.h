/// \file
/// How stiff a law is at small strain: what penalties and tolerances are measured by.
#pragma once

#include <lefort/fem/materials/material.h>

namespace lefort::solve {

/// Young's modulus of the isotropic law nearest to the tangent at rest [MPa].
[[nodiscard]] double young_modulus_at_rest_mpa(const fem::Material& material);

}  // namespace lefort::solve
