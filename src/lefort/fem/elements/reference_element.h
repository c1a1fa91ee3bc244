/// \file
/// An element in its reference configuration: where strain is taken, and for how much volume.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/elements/quadrature_point.h>

#include <tl/expected.hpp>

#include <algorithm>
#include <array>

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

/// Why an element cannot be used: where its Jacobian, by which the volume grows, is not positive.
struct ElementFault {
  int node = -1;  ///< The local node where; -1 at an integration point: no volume there at all.
};

namespace internal {

/// The gradients at the nodes of the reference element.
template <class Element>
std::array<Eigen::Matrix<double, 3, Element::kNodes>, Element::kNodes> gradients_at_nodes() {
  std::array<Eigen::Matrix<double, 3, Element::kNodes>, Element::kNodes> gradients;
  for (int a = 0; a < Element::kNodes; ++a)
    gradients[std::size_t(a)] = Element::gradients(Element::nodes().col(a));
  return gradients;
}

}  // namespace internal

/// The Jacobian must be positive, but for round-off, at the integration points and at the nodes,
/// where the sides of a bad element fold first. (In between it may still not be: to know that of a
/// curved element would need bounds on the whole polynomial.) At the apex of a pyramid it has no
/// single value; those along its edges are the ones at the corners of the base.
///
/// \param X  reference positions of the nodes [mm].
/// \returns gradients and volumes at the integration points, or the first fault found.
template <class Element>
[[nodiscard]] tl::expected<ReferenceElement<Element>, ElementFault> reference_element(
    const ElementNodes<Element>& X) {
  constexpr double kFlat = 1e-12;  // Least volume, as a share of the longest edge's cube.
  double longest = 0.0;
  for (int a = 1; a < Element::kNodes; ++a)
    longest = std::max(longest, (X.col(a) - X.col(0)).norm());
  const double minimum = kFlat * longest * longest * longest;

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
