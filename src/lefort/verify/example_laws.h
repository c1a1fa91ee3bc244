/// \file
/// One example of every law, with its constants.
#pragma once

#include <lefort/fem/materials/material.h>

#include <string>
#include <vector>

namespace lefort::verify {

struct NamedLaw {
  std::string name;
  fem::Material law;
};

/// Material axes lie along x, y, z and fibers along x. Fung's law has equal constants in y and z,
/// so that a body stretched along x contracts equally in both.
///
/// \param kappa_mpa  bulk modulus of decoupled laws, whose shear moduli are 0.4 to 1 MPa.
[[nodiscard]] std::vector<NamedLaw> example_laws(double kappa_mpa);

}  // namespace lefort::verify
