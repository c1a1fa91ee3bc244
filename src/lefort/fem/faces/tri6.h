/// \file
/// The triangle with six nodes: a face of tet10 and wedge15.
///
/// Corners 0 to 2 as in tri3.h; then the mid-edge nodes, as VTK_QUADRATIC_TRIANGLE:
///   3 (0,1)   4 (1,2)   5 (2,0)
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// With L0 = 1 - xi - eta, L1 = xi, L2 = eta: corners L (2 L - 1), mid-edge nodes 4 Li Lj.
struct Tri6 {
  static constexpr mesh::FaceShape kShape = mesh::FaceShape::kTri6;
  static constexpr int kNodes = 6;
  static constexpr int kPoints = 6;

  [[nodiscard]] static Eigen::Matrix<double, 2, kNodes> nodes() {
    Eigen::Matrix<double, 2, kNodes> xi;
    xi << 0, 1, 0, .5, .5, 0,  //
        0, 0, 1, 0, .5, .5;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Eigen::Vector2d& xi) {
    const Vec3 L(1.0 - xi.sum(), xi[0], xi[1]);
    Eigen::Matrix<double, kNodes, 1> N;
    for (int i = 0; i < 3; ++i) {
      N[i] = L[i] * (2.0 * L[i] - 1.0);
      N[3 + i] = 4.0 * L[i] * L[(i + 1) % 3];
    }
    return N;
  }

  [[nodiscard]] static Eigen::Matrix<double, 2, kNodes> gradients(const Eigen::Vector2d& xi) {
    const Vec3 L(1.0 - xi.sum(), xi[0], xi[1]);
    Eigen::Matrix<double, 2, 3> dL;
    dL << -1, 1, 0,  //
        -1, 0, 1;
    Eigen::Matrix<double, 2, kNodes> dN;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      dN.col(i) = (4.0 * L[i] - 1.0) * dL.col(i);
      dN.col(3 + i) = 4.0 * (L[i] * dL.col(j) + L[j] * dL.col(i));
    }
    return dN;
  }

  /// Exact to degree 4: a uniform pressure on any curved face.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes, 2>, kPoints> quadrature() {
    return at_points<Tri6>(triangle_6());
  }
};

}  // namespace lefort::fem
