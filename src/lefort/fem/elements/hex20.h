/// \file
/// The hexahedron with twenty nodes: quadratic displacement of the serendipity family.
///
/// Corners 0 to 7 as in hex8.h; then the mid-edge nodes, as VTK_QUADRATIC_HEXAHEDRON:
///
///        7----14---6          8 (0,1)    9 (1,2)   10 (2,3)   11 (3,0)
///      15|       13|         12 (4,5)   13 (5,6)   14 (6,7)   15 (7,4)
///      4----12---5 18        16 (0,4)   17 (1,5)   18 (2,6)   19 (3,7)
///      | 19      | |
///     16 3----10-17-2
///      |11       |9
///      0----8----1
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// With s = 1 + xi_a xi, t = 1 + eta_a eta, u = 1 + zeta_a zeta (\cite hughes2000, section 3.7):
/// corners s t u (s + t + u - 5) / 8; mid-edge nodes of edges along xi (1 - xi^2) t u / 4, along
/// eta and zeta likewise.
struct Hex20 {
  static constexpr mesh::ElementShape kShape = mesh::ElementShape::kHex20;
  static constexpr int kNodes = 20;
  static constexpr int kPoints = 27;

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> nodes() {
    Eigen::Matrix<double, 3, kNodes> xi;
    xi << -1, 1, 1, -1, -1, 1, 1, -1, 0, 1, 0, -1, 0, 1, 0, -1, -1, 1, 1, -1,  //
        -1, -1, 1, 1, -1, -1, 1, 1, -1, 0, 1, 0, -1, 0, 1, 0, -1, -1, 1, 1,    //
        -1, -1, -1, -1, 1, 1, 1, 1, -1, -1, -1, -1, 1, 1, 1, 1, 0, 0, 0, 0;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Vec3& xi) {
    const Eigen::Matrix<double, 3, kNodes> at = nodes();
    Eigen::Matrix<double, kNodes, 1> N;
    for (int a = 0; a < kNodes; ++a) {
      const Vec3 s = Vec3::Ones() + at.col(a).cwiseProduct(xi);
      if (a < 8) {
        N[a] = s.prod() * (s.sum() - 5.0) / 8.0;
      } else {
        const int d = axis_of_edge(a);  // s is 1 along it.
        N[a] = s.prod() * (1.0 - xi[d] * xi[d]) / 4.0;
      }
    }
    return N;
  }

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> gradients(const Vec3& xi) {
    const Eigen::Matrix<double, 3, kNodes> at = nodes();
    Eigen::Matrix<double, 3, kNodes> dN;
    for (int a = 0; a < kNodes; ++a) {
      const Vec3 s = Vec3::Ones() + at.col(a).cwiseProduct(xi);
      // Derivatives of s t u.
      const Vec3 ds = at.col(a).cwiseProduct(Vec3(s[1] * s[2], s[2] * s[0], s[0] * s[1]));
      if (a < 8) {
        dN.col(a) = (ds * (s.sum() - 5.0) + s.prod() * at.col(a)) / 8.0;
      } else {
        const int d = axis_of_edge(a);
        dN.col(a) = ds * (1.0 - xi[d] * xi[d]) / 4.0;
        dN(d, a) = -2.0 * xi[d] * s.prod() / 4.0;
      }
    }
    return dN;
  }

  /// 3 x 3 x 3: exact for the stiffness of parallelepipeds and for the volume of any element.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    return at_points<Hex20>(product(product(gauss_3(), gauss_3()), gauss_3()));
  }

 private:
  /// \returns the coordinate along the edge of node a, 8 to 19.
  static constexpr int axis_of_edge(int a) { return a >= 16 ? 2 : a % 2; }
};

}  // namespace lefort::fem
