/// \file
/// An element in its reference configuration: where strain is taken, and for how much volume.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/elements/quadrature_point.h>

#include <algorithm>
#include <array>
#include <optional>

namespace lefort::fem {

/// Where strain is taken in one element: gradients by the reference position X.
template <class Element>
struct ReferencePoint {
  Eigen::Matrix<double, 3, Element::kNodes> dN_dX;  ///< Column a: gradient of N_a [1/mm].
  double volume_mm3 = 0.0;                          ///< Reference volume it stands for.
};

/// The points of one element.
template <class Element>
using ReferenceElement = std::array<ReferencePoint<Element>, Element::kPoints>;

/// Node positions of one element, column by column [mm].
template <class Element>
using ElementNodes = Eigen::Matrix<double, 3, Element::kNodes>;

/// F = sum over nodes of x_a (x) dN_a/dX (eq. 9.5 of \cite bonet2008).
template <class Element, class Positions>
[[nodiscard]] Mat3 deformation_gradient(const Positions& x, const ReferencePoint<Element>& point) {
  return x * point.dN_dX.transpose();
}

/// \param X  reference positions of the nodes [mm].
/// \returns gradients and volumes at the integration points; nothing if the volume at one of them
///   is not positive, but for round-off.
template <class Element>
[[nodiscard]] std::optional<ReferenceElement<Element>> reference_element(
    const ElementNodes<Element>& X) {
  constexpr double kFlat = 1e-12;  // Least volume, as a share of the longest edge's cube.
  double longest = 0.0;
  for (int a = 1; a < Element::kNodes; ++a)
    longest = std::max(longest, (X.col(a) - X.col(0)).norm());

  const auto quadrature = Element::quadrature();
  ReferenceElement<Element> points;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Mat3 dX_dxi = X * quadrature[q].dN_dxi.transpose();
    const double jacobian = dX_dxi.determinant();
    if (!(jacobian > kFlat * longest * longest * longest)) return std::nullopt;
    points[q].dN_dX = dX_dxi.inverse().transpose() * quadrature[q].dN_dxi;
    points[q].volume_mm3 = jacobian * quadrature[q].weight;
  }
  return points;
}

}  // namespace lefort::fem
