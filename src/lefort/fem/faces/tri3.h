/// \file
/// The triangle with three nodes: a face of tet4, wedge6 and pyramid5.
///
///      2
///      |`.        Reference coordinates xi, eta >= 0, xi + eta <= 1:
///      |  `.        node 0 (0,0)   node 1 (1,0)   node 2 (0,1)
///      0----1     Counter-clockwise seen from outside, as VTK_TRIANGLE.
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// N0 = 1 - xi - eta, N1 = xi, N2 = eta.
struct Tri3 {
  static constexpr mesh::FaceShape kShape = mesh::FaceShape::kTri3;
  static constexpr int kNodes = 3;
  static constexpr int kPoints = 3;

  [[nodiscard]] static Eigen::Matrix<double, 2, kNodes> nodes() {
    Eigen::Matrix<double, 2, kNodes> xi;
    xi << 0, 1, 0,  //
        0, 0, 1;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Eigen::Vector2d& xi) {
    return {1.0 - xi.sum(), xi[0], xi[1]};
  }

  [[nodiscard]] static Eigen::Matrix<double, 2, kNodes> gradients(const Eigen::Vector2d& /*xi*/) {
    Eigen::Matrix<double, 2, kNodes> dN;
    dN << -1, 1, 0,  //
        -1, 0, 1;
    return dN;
  }

  /// Exact for quadratic functions, such as a linear traction times a shape function.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes, 2>, kPoints> quadrature() {
    return at_points<Tri3>(triangle_3());
  }
};

}  // namespace lefort::fem
