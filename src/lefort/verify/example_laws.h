/// \file
/// One example of every law, with its constants, for the cases that run through all.
#pragma once

#include <lefort/fem/materials/material.h>

#include <string>
#include <vector>

namespace lefort::verify {

struct NamedLaw {
  std::string name;
  fem::Material law;
};

/// \param kappa_mpa  bulk modulus of those in split form, whose shear moduli are about 1 MPa.
///
/// Material axes and fibers lie along x, y, z; Fung's law has equal constants in y and z, so that a
/// stretch along x is free to contract alike in both.
[[nodiscard]] std::vector<NamedLaw> example_laws(double kappa_mpa);

}  // namespace lefort::verify
