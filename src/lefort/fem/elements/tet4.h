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

namespace lefort::fem {

/// N0 = 1 - xi - eta - zeta, N1 = xi, N2 = eta, N3 = zeta. Locks for nearly incompressible laws.
struct Tet4 {
  static constexpr mesh::ElementShape kShape = mesh::ElementShape::kTet4;
  static constexpr int kNodes = 4;
  static constexpr int kPoints = 1;

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> nodes() {
    Eigen::Matrix<double, 3, kNodes> xi;
    xi << 0, 1, 0, 0,  //
        0, 0, 1, 0,    //
        0, 0, 0, 1;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Vec3& xi) {
    return {1.0 - xi.sum(), xi[0], xi[1], xi[2]};
  }

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> gradients(const Vec3& /*xi*/) {
    Eigen::Matrix<double, 3, kNodes> dN;
    dN << -1, 1, 0, 0,  //
        -1, 0, 1, 0,    //
        -1, 0, 0, 1;
    return dN;
  }

  /// One point, the centroid: exact, since the gradients are constant.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    return at_points<Tet4>(Rule<3, kPoints>{{{Vec3::Constant(0.25), 1.0 / 6.0}}});
  }
};

}  // namespace lefort::fem
