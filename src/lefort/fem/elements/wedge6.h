/// \file
/// The wedge with six nodes: linear in the triangle times linear along the axis.
///
///         4
///        /|`.           Reference coordinates xi, eta >= 0, xi + eta <= 1; zeta from -1 to 1:
///       / |  `.           node 0 (0,0,-1)   node 3 (0,0,1)
///      3--|----5          node 1 (0,1,-1)   node 4 (0,1,1)
///      |  1.   |          node 2 (1,0,-1)   node 5 (1,0,1)
///      | /  `. |        As VTK_WEDGE is documented: seen from outside (below), nodes 0, 1, 2 turn
///      |/     `|        counter-clockwise. (VTK's own parametric coordinates, and many programs,
///      0-------2        exchange 1 and 2, and 4 and 5.)
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// With L0 = 1 - xi - eta, L1 = eta, L2 = xi: L (1 - zeta) / 2 below, L (1 + zeta) / 2 above.
struct Wedge6 {
  static constexpr mesh::ElementShape kShape = mesh::ElementShape::kWedge6;
  static constexpr int kNodes = 6;
  static constexpr int kPoints = 6;

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> nodes() {
    Eigen::Matrix<double, 3, kNodes> xi;
    xi << 0, 0, 1, 0, 0, 1,  //
        0, 1, 0, 0, 1, 0,    //
        -1, -1, -1, 1, 1, 1;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Vec3& xi) {
    const Vec3 L(1.0 - xi[0] - xi[1], xi[1], xi[0]);
    Eigen::Matrix<double, kNodes, 1> N;
    N << L * (1.0 - xi[2]) / 2.0, L * (1.0 + xi[2]) / 2.0;
    return N;
  }

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> gradients(const Vec3& xi) {
    const Vec3 L(1.0 - xi[0] - xi[1], xi[1], xi[0]);
    Eigen::Matrix<double, 2, 3> dL;
    dL << -1, 0, 1,  //
        -1, 1, 0;
    Eigen::Matrix<double, 3, kNodes> dN;
    dN << dL * (1.0 - xi[2]) / 2.0, dL * (1.0 + xi[2]) / 2.0,  //
        -L.transpose() / 2.0, L.transpose() / 2.0;
    return dN;
  }

  /// 3 of the triangle x 2: exact for the stiffness of right wedges and their affine images, and
  /// for the volume of any element.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    return at_points<Wedge6>(product(triangle_3(), gauss_2()));
  }
};

}  // namespace lefort::fem
