/// \file
/// An element in the reference configuration: gradients and volumes of its quadrature points.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/elements/quadrature_point.h>

#include <tl/expected.hpp>

#include <algorithm>
#include <array>

namespace lefort::fem {

/// A quadrature point of one element, with gradients by the reference position X.
template <class Element>
struct ReferencePoint {
  Eigen::Matrix<double, 3, Element::kNodes> dN_dX;  ///< Column a: gradient of N_a [1/mm].
  double volume_mm3 = 0.0;                          ///< Weight times Jacobian.
};

/// The quadrature points of one element.
template <class Element>
using ReferenceElement = std::array<ReferencePoint<Element>, Element::kPoints>;

/// Node positions of one element, column by column [mm].
template <class Element>
using ElementNodes = Eigen::Matrix<double, 3, Element::kNodes>;

/// F = sum over nodes of x_a (x) dN_a/dX (\cite bonet2008, section 9.2).
template <class Element, class Positions>
[[nodiscard]] Mat3 deformation_gradient(const Positions& x, const ReferencePoint<Element>& point) {
  return x * point.dN_dX.transpose();
}

/// Position of a reference Jacobian that is not positive: the element is invalid.
struct ElementFault {
  int node = -1;  ///< Local node; -1 for a quadrature point.
};

namespace internal {

/// \returns the gradients at the nodes of the reference element.
template <class Element>
std::array<Eigen::Matrix<double, 3, Element::kNodes>, Element::kNodes> gradients_at_nodes() {
  std::array<Eigen::Matrix<double, 3, Element::kNodes>, Element::kNodes> gradients;
  for (int a = 0; a < Element::kNodes; ++a)
    gradients[std::size_t(a)] = Element::gradients(Element::nodes().col(a));
  return gradients;
}

}  // namespace internal

/// The Jacobian must be positive beyond round-off at the quadrature points and at the nodes, where
/// a bad element folds first. (It may still be negative elsewhere in a curved element; to exclude
/// that, bounds of the whole polynomial would be needed.) At the apex of a pyramid it is not
/// unique; its values along the edges are those at the corners of the base.
///
/// \param X  reference positions of the nodes [mm].
/// \returns gradients and volumes at the quadrature points, or the first invalid position.
template <class Element>
[[nodiscard]] tl::expected<ReferenceElement<Element>, ElementFault> reference_element(
    const ElementNodes<Element>& X) {
  constexpr double kMinVolume = 1e-12;  // Relative to the cube of the longest edge; round-off.
  double longest = 0.0;
  for (int a = 1; a < Element::kNodes; ++a)
    longest = std::max(longest, (X.col(a) - X.col(0)).norm());
  const double minimum = kMinVolume * longest * longest * longest;

  static const auto kQuadrature = Element::quadrature();
  static const auto kAtNodes = internal::gradients_at_nodes<Element>();
  ReferenceElement<Element> points;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Mat3 dX_dxi = X * kQuadrature[q].dN_dxi.transpose();
    const double jacobian = dX_dxi.determinant();
    if (!(jacobian > minimum)) return tl::unexpected(ElementFault{});
    points[q].dN_dX = dX_dxi.inverse().transpose() * kQuadrature[q].dN_dxi;
    points[q].volume_mm3 = jacobian * kQuadrature[q].weight;
  }
  for (int a = 0; a < Element::kNodes; ++a) {
    const Mat3 dX_dxi = X * kAtNodes[std::size_t(a)].transpose();
    if (!(dX_dxi.determinant() > minimum)) return tl::unexpected(ElementFault{a});
  }
  return points;
}

}  // namespace lefort::fem
