/// \file
/// The pyramid with five nodes: connects hexahedra and tetrahedra.
///
///            4              Reference coordinates |xi|, |eta| <= 1 - zeta, zeta from 0 to 1:
///          .'|`.              node 0 (-1,-1,0)   node 1 ( 1,-1,0)
///        .'  |  `.            node 2 ( 1, 1,0)   node 3 (-1, 1,0)
///       3----|----2           node 4 ( 0, 0,1)
///      /     |   /          As VTK_PYRAMID: seen from node 4, nodes 0, 1, 2, 3 turn
///     0---------1           counter-clockwise.
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/fem/elements/quadrature_rules.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::fem {

/// Rational shape functions (\cite bedrosian1992). With a = xi / (1 - zeta) and b = eta / (1 -
/// zeta): N_i = (1 - zeta) (1 + xi_i a) (1 + eta_i b) / 4 for the base, N_4 = zeta.
///
/// They are bilinear on the base and linear on the triangles, so that faces match those of
/// hexahedra, wedges and tetrahedra. As functions of position they equal those of a hexahedron
/// whose upper nodes coincide. Gradients depend on (a, b) only: they are constant along each ray
/// from the apex. At the apex they are not unique; gradients() returns those of the axis.
struct Pyramid5 {
  static constexpr mesh::ElementShape kShape = mesh::ElementShape::kPyramid5;
  static constexpr int kNodes = 5;
  static constexpr int kPoints = 4;

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> nodes() {
    Eigen::Matrix<double, 3, kNodes> xi;
    xi << -1, 1, 1, -1, 0,  //
        -1, -1, 1, 1, 0,    //
        0, 0, 0, 0, 1;
    return xi;
  }

  [[nodiscard]] static Eigen::Matrix<double, kNodes, 1> functions(const Vec3& xi) {
    const Eigen::Matrix<double, 3, kNodes> at = nodes();
    const auto [a, b] = ray(xi);
    Eigen::Matrix<double, kNodes, 1> N;
    for (int i = 0; i < 4; ++i)
      N[i] = (1.0 - xi[2]) * (1.0 + at(0, i) * a) * (1.0 + at(1, i) * b) / 4.0;
    N[4] = xi[2];
    return N;
  }

  [[nodiscard]] static Eigen::Matrix<double, 3, kNodes> gradients(const Vec3& xi) {
    const Eigen::Matrix<double, 3, kNodes> at = nodes();
    const auto [a, b] = ray(xi);
    Eigen::Matrix<double, 3, kNodes> dN;
    for (int i = 0; i < 4; ++i) {
      const double s = at(0, i);
      const double t = at(1, i);
      dN.col(i) = Vec3(s * (1.0 + t * b), t * (1.0 + s * a), s * t * a * b - 1.0) / 4.0;
    }
    dN.col(4) = Vec3::UnitZ();
    return dN;
  }

  /// 2 x 2 rays, each with one point at the height of the centroid: exact along each ray for any
  /// law and shape. Over the element they are exact for the stiffness of affine elements, and for
  /// the volume of any element.
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    constexpr double kHeight = 0.25;
    Rule<3, kPoints> rule;
    const Rule<2, 4> base = product(gauss_2(), gauss_2());
    for (std::size_t q = 0; q < base.size(); ++q) {
      const Eigen::Vector2d at_height = (1.0 - kHeight) * base[q].xi;
      rule[q] = {Vec3(at_height[0], at_height[1], kHeight), base[q].weight / 3.0};
    }
    return at_points<Pyramid5>(rule);
  }

 private:
  /// \returns (a, b) of the ray from the apex through xi; the axis for the apex itself.
  static std::array<double, 2> ray(const Vec3& xi) {
    const double width = 1.0 - xi[2];
    if (width == 0.0) return {0.0, 0.0};
    return {xi[0] / width, xi[1] / width};
  }
};

}  // namespace lefort::fem
