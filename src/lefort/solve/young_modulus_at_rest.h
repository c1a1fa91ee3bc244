/// \file
/// Stiffness of a law at small strain, a reference for penalties, tolerances and warnings.
#pragma once

#include <lefort/fem/materials/material.h>

namespace lefort::solve {

/// Constants of Hooke's law whose Lame constants are means of the components of the tangent of
/// `material` in the reference configuration.
[[nodiscard]] double young_modulus_at_rest_mpa(const fem::Material& material);
[[nodiscard]] double poisson_ratio_at_rest(const fem::Material& material);

}  // namespace lefort::solve
