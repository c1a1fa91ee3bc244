/// \file
/// Independent second implementation of every law in principal stretches, with which fem/materials
/// is compared.
///
/// Principal axes are x, y, z, along the material axes and fibers of example_laws(). Decoupled laws
/// must have VolumetricForm::kQuadraticLog. For one with isochoric energy W(l1, l2, l3) of the
/// isochoric stretches l_i = J^(-1/3) lambda_i,
///
///     P_i = (m_i - (m_1 + m_2 + m_3)/3 + J U'(J)) / lambda_i ,   m_i = l_i dW/dl_i
///
/// (\cite ogden1984, chapter 7).
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/materials/material.h>

namespace lefort::verify {

/// Principal nominal stresses [MPa] at the principal stretches.
[[nodiscard]] Vec3 principal_stress(const fem::Material& law, const Vec3& stretches);

/// Nominal shear stress P_yx [MPa] of x' = x, y' = y + gamma x, z' = z: for isotropic laws from the
/// principal stretches, for the others dW/dgamma.
[[nodiscard]] double simple_shear_stress(const fem::Material& law, double gamma);

/// Response of a stretched body without stress in the free directions.
struct FreeStretch {
  double stress_mpa = 0.0;  ///< Nominal stress along x.
  double lateral = 1.0;     ///< Stretch in the free directions.
};

/// Stretched along x; y and z are free and contract equally.
[[nodiscard]] FreeStretch uniaxial(const fem::Material& law, double stretch);

/// Stretched equally along x and y; z is free.
[[nodiscard]] FreeStretch equibiaxial(const fem::Material& law, double stretch);

/// Nominal uniaxial stress [MPa] of an incompressible body: the limit of large kappa.
[[nodiscard]] double incompressible_uniaxial(const fem::Material& law, double stretch);

}  // namespace lefort::verify
