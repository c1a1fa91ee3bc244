/// \file
/// The linear shape with the corners of an element shape.
#pragma once

#include <lefort/fem/elements/all_elements.h>

namespace lefort::fem {

/// Its nodes are the first nodes of `Element`, and both have the same reference coordinates.
template <class Element>
struct CornerShapeOf {
  using Type = Element;
};
template <>
struct CornerShapeOf<Tet10> {
  using Type = Tet4;
};
template <>
struct CornerShapeOf<Wedge15> {
  using Type = Wedge6;
};
template <>
struct CornerShapeOf<Hex20> {
  using Type = Hex8;
};

template <class Element>
using CornerShape = typename CornerShapeOf<Element>::Type;

/// \param N  values of the functions of `Element` at a point.
/// \returns the values of the functions of its corner shape at this point.
template <class Element>
[[nodiscard]] Eigen::Matrix<double, CornerShape<Element>::kNodes, 1> corner_functions(
    const Eigen::Matrix<double, Element::kNodes, 1>& N) {
  // The functions of every shape reproduce its reference coordinates.
  return CornerShape<Element>::functions(Element::nodes() * N);
}

}  // namespace lefort::fem
