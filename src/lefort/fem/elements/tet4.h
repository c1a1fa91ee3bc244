/// \file
/// The tetrahedron with four nodes: linear displacement, constant strain.
///
///          3
///         /|`.           Reference coordinates xi, eta, zeta >= 0, their sum <= 1:
///        / |  `.           node 0 (0,0,0)   node 1 (1,0,0)
///       /  2.   `.         node 2 (0,1,0)   node 3 (0,0,1)
///      / .'  `-.  `.     As VTK_TETRA: seen from node 3, nodes 0, 1, 2 turn
///     /.'       `-. `.   counter-clockwise.
///    0---------------1
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>

namespace lefort::fem {

/// N0 = 1 - xi - eta - zeta, N1 = xi, N2 = eta, N3 = zeta. Locks for nearly incompressible laws.
struct Tet4 {
  static constexpr mesh::ElementShape kShape = mesh::ElementShape::kTet4;
  static constexpr int kNodes = 4;
  static constexpr int kPoints = 1;

  /// One point, the centroid: exact, for the gradients are constant.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    QuadraturePoint<kNodes> centroid;
    centroid.weight = 1.0 / 6.0;
    // Columns: nodes; rows: d/dxi, d/deta, d/dzeta.
    centroid.dN_dxi << -1, 1, 0, 0,  //
        -1, 0, 1, 0,                 //
        -1, 0, 0, 1;
    return {centroid};
  }
};

}  // namespace lefort::fem
