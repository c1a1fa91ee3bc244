/// \file
/// An element in the reference configuration: gradients and volumes of its quadrature points.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/elements/gradient_products.h>
#include <lefort/fem/elements/quadrature_point.h>

#include <tl/expected.hpp>

#include <array>

namespace lefort::fem {

/// A quadrature point of one element, with gradients with respect to the reference position X.
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
  return sum_of_dyads<Element::kNodes>(x.data(), point.dN_dX.data());
}

/// Position of a reference Jacobian that is not positive: the element is invalid.
struct ElementFault {
  int node = -1;  ///< Local node; -1 for a quadrature point.
};

/// Computes the gradients and volumes of an element and checks its Jacobian.
///
/// The Jacobian must be positive beyond round-off at the quadrature points and at the nodes, where
/// a bad element folds first. (Elsewhere in a curved element it may still be negative; only bounds
/// of the whole polynomial could exclude this.) At the apex of a pyramid the Jacobian is not
/// unique. Along each edge from the apex it is constant, so the check of the base covers it.
///
/// Instances: the shapes of all_elements.h.
///
/// \param X  reference positions of the nodes [mm].
/// \returns gradients and volumes at the quadrature points, or the first invalid position.
template <class Element>
[[nodiscard]] tl::expected<ReferenceElement<Element>, ElementFault> reference_element(
    const ElementNodes<Element>& X);

}  // namespace lefort::fem
