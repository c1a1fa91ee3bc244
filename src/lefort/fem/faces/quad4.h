/// \file
/// The quadrilateral with four nodes: a face of hex8, wedge6 and pyramid5.
///
///      3----2     Reference coordinates from -1 to 1:
///      |    |       node 0 (-1,-1)   node 1 (1,-1)   node 2 (1,1)   node 3 (-1,1)
///      0----1     Counter-clockwise seen from outside, as VTK_QUAD.
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// N_a = (1 + xi_a xi) (1 + eta_a eta) / 4.
struct Quad4 {
  static constexpr mesh::FaceShape kShape = mesh::FaceShape::kQuad4;
  static constexpr int kNodes = 4;
  static constexpr int kPoints = 4;

  [[nodiscard]] static Eigen::Matrix<double, 2, kNodes> nodes() {
    Eigen::Matrix<double, 2, kNodes> xi;
    xi << -1, 1, 1, -1,  //
        -1, -1, 1, 1;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Eigen::Vector2d& xi) {
    const Eigen::Matrix<double, 2, kNodes> at = nodes();
    Eigen::Matrix<double, kNodes, 1> N;
    for (int a = 0; a < kNodes; ++a)
      N[a] = (1.0 + at(0, a) * xi[0]) * (1.0 + at(1, a) * xi[1]) / 4.0;
    return N;
  }

  [[nodiscard]] static Eigen::Matrix<double, 2, kNodes> gradients(const Eigen::Vector2d& xi) {
    const Eigen::Matrix<double, 2, kNodes> at = nodes();
    Eigen::Matrix<double, 2, kNodes> dN;
    for (int a = 0; a < kNodes; ++a) {
      dN(0, a) = at(0, a) * (1.0 + at(1, a) * xi[1]) / 4.0;
      dN(1, a) = at(1, a) * (1.0 + at(0, a) * xi[0]) / 4.0;
    }
    return dN;
  }

  /// 2 x 2, exact to degree 3 in each coordinate: a uniform pressure on any warped face.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes, 2>, kPoints> quadrature() {
    return at_points<Quad4>(product(gauss_2(), gauss_2()));
  }
};

}  // namespace lefort::fem
