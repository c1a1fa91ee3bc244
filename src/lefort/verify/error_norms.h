/// \file
/// Integrals over elements with fine quadrature: loads that vary in space, and error norms.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/loads/dead_load.h>
#include <lefort/mesh/volume_mesh.h>

#include <functional>
#include <vector>

namespace lefort::verify {

/// An exact displacement as a function of the reference position.
struct ExactField {
  std::function<Vec3(const Vec3& X)> displacement;  ///< [mm]
  std::function<Mat3(const Vec3& X)> gradient;      ///< du/dX.
};

/// |u_h - u| / |u|; the square of each norm is integrated over the reference volume.
struct ErrorNorms {
  double l2 = 0.0;  ///< Of displacements.
  double h1 = 0.0;  ///< Of their gradients.
};

/// \param mesh   at rest.
/// \param u      displacements of all nodes, 3 per node [mm].
/// \param exact  solution.
[[nodiscard]] ErrorNorms error_norms(const mesh::VolumeMesh& mesh, const VectorX& u,
                                     const ExactField& exact);

/// f_a = integral of N_a b dV, one force per node of the mesh.
///
/// \param mesh        at rest.
/// \param body_force  b per reference volume [N/mm^3], at X.
[[nodiscard]] std::vector<fem::NodalForce> nodal_forces(
    const mesh::VolumeMesh& mesh, const std::function<Vec3(const Vec3& X)>& body_force);

}  // namespace lefort::verify
