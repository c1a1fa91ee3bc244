/// \file
/// The tetrahedron with ten nodes: quadratic displacement, linear strain.
///
/// Corners 0 to 3 as in tet4.h; then the mid-edge nodes, as VTK_QUADRATIC_TETRA:
///   4 (0,1)   5 (1,2)   6 (2,0)   7 (0,3)   8 (1,3)   9 (2,3)
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/mesh/volume_mesh.h>

#include <cmath>

namespace lefort::fem {

/// With L0 = 1 - xi - eta - zeta, L1 = xi, L2 = eta, L3 = zeta: corners L (2 L - 1), edges 4 Li Lj.
struct Tet10 {
  static constexpr mesh::ElementShape kShape = mesh::ElementShape::kTet10;
  static constexpr int kNodes = 10;
  static constexpr int kPoints = 4;
  static constexpr std::array<std::array<int, 2>, 6> kEdges{
      {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> nodes() {
    Eigen::Matrix<double, 3, kNodes> xi;
    xi << 0, 1, 0, 0, .5, .5, 0, 0, .5, 0,  //
        0, 0, 1, 0, 0, .5, .5, 0, 0, .5,    //
        0, 0, 0, 1, 0, 0, 0, .5, .5, .5;
    return xi;
  }

  /// \returns the shape functions at the point with the barycentric coordinates L.
  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions_at(const Eigen::Vector4d& L) {
    Eigen::Matrix<double, kNodes, 1> N;
    for (int a = 0; a < 4; ++a) N[a] = L[a] * (2.0 * L[a] - 1.0);
    for (int e = 0; e < 6; ++e) {
      const auto [i, j] = kEdges[std::size_t(e)];
      N[4 + e] = 4.0 * L[i] * L[j];
    }
    return N;
  }

  /// \returns the gradients of the shape functions at that point, in reference coordinates.
  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> gradients_at(const Eigen::Vector4d& L) {
    Eigen::Matrix<double, 3, 4> dL;
    dL << -1, 1, 0, 0,  //
        -1, 0, 1, 0,    //
        -1, 0, 0, 1;
    Eigen::Matrix<double, 3, kNodes> dN;
    for (int a = 0; a < 4; ++a) dN.col(a) = (4.0 * L[a] - 1.0) * dL.col(a);
    for (int e = 0; e < 6; ++e) {
      const auto [i, j] = kEdges[std::size_t(e)];
      dN.col(4 + e) = 4.0 * (L[i] * dL.col(j) + L[j] * dL.col(i));
    }
    return dN;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Vec3& xi) {
    return functions_at({1.0 - xi.sum(), xi[0], xi[1], xi[2]});
  }

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> gradients(const Vec3& xi) {
    return gradients_at({1.0 - xi.sum(), xi[0], xi[1], xi[2]});
  }

  /// Four points, exact to degree 2 (\cite hammer1956): exact for the stiffness of elements with
  /// straight edges and centered mid-edge nodes.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    const double far = (5.0 - std::sqrt(5.0)) / 20.0;
    const double near = (5.0 + 3.0 * std::sqrt(5.0)) / 20.0;
    std::array<QuadraturePoint<kNodes>, kPoints> points;
    for (int q = 0; q < kPoints; ++q) {
      Eigen::Vector4d L = Eigen::Vector4d::Constant(far);
      L[q] = near;
      points[std::size_t(q)] = {
          .weight = 1.0 / 24.0, .N = functions_at(L), .dN_dxi = gradients_at(L)};
    }
    return points;
  }
};

}  // namespace lefort::fem
