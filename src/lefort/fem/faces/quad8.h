/// \file
/// The quadrilateral with eight nodes: a face of hex20 and wedge15.
///
/// Corners 0 to 3 as in quad4.h; then the mid-edge nodes, as VTK_QUADRATIC_QUAD:
///   4 (0,1)   5 (1,2)   6 (2,3)   7 (3,0)
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// With s = 1 + xi_a xi, t = 1 + eta_a eta (\cite hughes2000, section 3.7): corners
/// s t (s + t - 3) / 4; mid-edge nodes of edges along xi (1 - xi^2) t / 2, along eta likewise.
struct Quad8 {
  static constexpr mesh::FaceShape kShape = mesh::FaceShape::kQuad8;
  static constexpr int kNodes = 8;
  static constexpr int kPoints = 9;

  [[nodiscard]] static Eigen::Matrix<double, 2, kNodes> nodes() {
    Eigen::Matrix<double, 2, kNodes> xi;
    xi << -1, 1, 1, -1, 0, 1, 0, -1,  //
        -1, -1, 1, 1, -1, 0, 1, 0;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Eigen::Vector2d& xi) {
    const Eigen::Matrix<double, 2, kNodes> at = nodes();
    Eigen::Matrix<double, kNodes, 1> N;
    for (int a = 0; a < kNodes; ++a) {
      const double s = 1.0 + at(0, a) * xi[0];
      const double t = 1.0 + at(1, a) * xi[1];
      const int d = a % 2;  // Coordinate along the edge of a mid-edge node.
      N[a] = a < 4 ? s * t * (s + t - 3.0) / 4.0 : s * t * (1.0 - xi[d] * xi[d]) / 2.0;
    }
    return N;
  }

  [[nodiscard]] static Eigen::Matrix<double, 2, kNodes> gradients(const Eigen::Vector2d& xi) {
    const Eigen::Matrix<double, 2, kNodes> at = nodes();
    Eigen::Matrix<double, 2, kNodes> dN;
    for (int a = 0; a < kNodes; ++a) {
      const double s = 1.0 + at(0, a) * xi[0];
      const double t = 1.0 + at(1, a) * xi[1];
      if (a < 4) {
        dN(0, a) = at(0, a) * t * (2.0 * s + t - 3.0) / 4.0;
        dN(1, a) = at(1, a) * s * (s + 2.0 * t - 3.0) / 4.0;
      } else if (a % 2 == 0) {
        dN(0, a) = -xi[0] * t;
        dN(1, a) = at(1, a) * (1.0 - xi[0] * xi[0]) / 2.0;
      } else {
        dN(0, a) = at(0, a) * (1.0 - xi[1] * xi[1]) / 2.0;
        dN(1, a) = -xi[1] * s;
      }
    }
    return dN;
  }

  /// 3 x 3, exact to degree 5 in each coordinate: a uniform pressure on any curved face.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes, 2>, kPoints> quadrature() {
    return at_points<Quad8>(product(gauss_3(), gauss_3()));
  }
};

}  // namespace lefort::fem
