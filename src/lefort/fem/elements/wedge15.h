/// \file
/// The wedge with fifteen nodes: quadratic displacement of the serendipity family.
///
/// Corners 0 to 5 as in wedge6.h; then the mid-edge nodes, as VTK_QUADRATIC_WEDGE:
///    6 (0,1)    7 (1,2)    8 (2,0)
///    9 (3,4)   10 (4,5)   11 (5,3)
///   12 (0,3)   13 (1,4)   14 (2,5)
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// With L0 = 1 - xi - eta, L1 = eta, L2 = xi and u = 1 + zeta_a zeta (\cite zienkiewicz2005):
/// corners L u (2 L + u - 3) / 2, edges of the triangles 2 Li Lj u, other edges
/// L (1 - zeta^2).
struct Wedge15 {
  static constexpr mesh::ElementShape kShape = mesh::ElementShape::kWedge15;
  static constexpr int kNodes = 15;
  static constexpr int kPoints = 18;

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> nodes() {
    Eigen::Matrix<double, 3, kNodes> xi;
    xi << 0, 0, 1, 0, 0, 1, 0, .5, .5, 0, .5, .5, 0, 0, 1,  //
        0, 1, 0, 0, 1, 0, .5, .5, 0, .5, .5, 0, 0, 1, 0,    //
        -1, -1, -1, 1, 1, 1, -1, -1, -1, 1, 1, 1, 0, 0, 0;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Vec3& xi) {
    const Vec3 L(1.0 - xi[0] - xi[1], xi[1], xi[0]);
    Eigen::Matrix<double, kNodes, 1> N;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      for (int side = 0; side < 2; ++side) {
        const double u = side == 0 ? 1.0 - xi[2] : 1.0 + xi[2];
        N[3 * side + i] = L[i] * u * (2.0 * L[i] + u - 3.0) / 2.0;
        N[6 + 3 * side + i] = 2.0 * L[i] * L[j] * u;
      }
      N[12 + i] = L[i] * (1.0 - xi[2] * xi[2]);
    }
    return N;
  }

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> gradients(const Vec3& xi) {
    const Vec3 L(1.0 - xi[0] - xi[1], xi[1], xi[0]);
    Eigen::Matrix<double, 2, 3> dL;
    dL << -1, 0, 1,  //
        -1, 1, 0;
    Eigen::Matrix<double, 3, kNodes> dN;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      for (int side = 0; side < 2; ++side) {
        const double du = side == 0 ? -1.0 : 1.0;
        const double u = 1.0 + du * xi[2];
        dN.col(3 * side + i) << dL.col(i) * u * (4.0 * L[i] + u - 3.0) / 2.0,
            du * L[i] * (2.0 * L[i] + 2.0 * u - 3.0) / 2.0;
        dN.col(6 + 3 * side + i) << 2.0 * u * (L[i] * dL.col(j) + L[j] * dL.col(i)),
            2.0 * du * L[i] * L[j];
      }
      dN.col(12 + i) << dL.col(i) * (1.0 - xi[2] * xi[2]), -2.0 * xi[2] * L[i];
    }
    return dN;
  }

  /// 6 of the triangle x 3: exact for the stiffness of right wedges and their affine images, and
  /// for the volume of any element.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    return at_points<Wedge15>(product(triangle_6(), gauss_3()));
  }
};

}  // namespace lefort::fem
