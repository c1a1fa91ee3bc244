/// \file
/// The hexahedron with eight nodes: trilinear displacement.
///
///        7---------6        Reference coordinates from -1 to 1:
///       /|        /|          node 0 (-1,-1,-1)   node 4 (-1,-1,1)
///      4---------5 |          node 1 ( 1,-1,-1)   node 5 ( 1,-1,1)
///      | |       | |          node 2 ( 1, 1,-1)   node 6 ( 1, 1,1)
///      | 3-------|-2          node 3 (-1, 1,-1)   node 7 (-1, 1,1)
///      |/        |/         As VTK_HEXAHEDRON.
///      0---------1
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// N_a = (1 + xi_a xi) (1 + eta_a eta) (1 + zeta_a zeta) / 8. Locks for nearly incompressible laws.
struct Hex8 {
  static constexpr mesh::ElementShape kShape = mesh::ElementShape::kHex8;
  static constexpr int kNodes = 8;
  static constexpr int kPoints = 8;

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> nodes() {
    Eigen::Matrix<double, 3, kNodes> xi;
    xi << -1, 1, 1, -1, -1, 1, 1, -1,  //
        -1, -1, 1, 1, -1, -1, 1, 1,    //
        -1, -1, -1, -1, 1, 1, 1, 1;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Vec3& xi) {
    const Eigen::Matrix<double, 3, kNodes> at = nodes();
    Eigen::Matrix<double, kNodes, 1> N;
    for (int a = 0; a < kNodes; ++a)
      N[a] = (1.0 + at(0, a) * xi[0]) * (1.0 + at(1, a) * xi[1]) * (1.0 + at(2, a) * xi[2]) / 8.0;
    return N;
  }

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> gradients(const Vec3& xi) {
    const Eigen::Matrix<double, 3, kNodes> at = nodes();
    Eigen::Matrix<double, 3, kNodes> dN;
    for (int a = 0; a < kNodes; ++a) {
      const Vec3 s = Vec3::Ones() + at.col(a).cwiseProduct(xi);
      dN.col(a) = at.col(a).cwiseProduct(Vec3(s[1] * s[2], s[2] * s[0], s[0] * s[1])) / 8.0;
    }
    return dN;
  }

  /// 2 x 2 x 2: exact for the stiffness of parallelepipeds and for the volume of any element.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    return at_points<Hex8>(product(product(gauss_2(), gauss_2()), gauss_2()));
  }
};

}  // namespace lefort::fem
