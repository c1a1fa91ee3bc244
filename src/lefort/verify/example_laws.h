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

/// \param kappa_mpa  bulk modulus of decoupled laws, whose shear moduli are about 1 MPa.
///
/// Material axes and fibers lie along x, y, z; Fung's law has equal constants in y and z, so that a
/// body stretched along x contracts equally in both.
[[nodiscard]] std::vector<NamedLaw> example_laws(double kappa_mpa);

}  // namespace lefort::verify
