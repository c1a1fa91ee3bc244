/// \file
/// Stiffness of a law at small strain, a reference for penalties and tolerances.
#pragma once

#include <lefort/fem/materials/material.h>

namespace lefort::solve {

/// Young's modulus [MPa] of Hooke's law whose Lame constants are means of the components of the
/// tangent in the reference configuration.
[[nodiscard]] double young_modulus_at_rest_mpa(const fem::Material& material);

}  // namespace lefort::solve
