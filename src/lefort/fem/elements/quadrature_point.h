/// \file
/// Interface of element and face shapes, and their quadrature points.
///
/// A shape (tet4.h, hex20.h, ... and those of ../faces) is an empty struct with
///
///     kShape, kNodes, kPoints
///     nodes()         reference coordinates of its nodes, column by column
///     functions(xi)   values of its shape functions at xi
///     gradients(xi)   their gradients at xi
///     quadrature()    its kPoints points for the strain energy, or for loads on a face
///
/// all_elements.h and all_faces.h list the shapes. The rules of fine_quadrature.h have more points.
#pragma once

#include <lefort/core/types.h>

#include <array>
#include <cstddef>

namespace lefort::fem {

/// A point of a quadrature rule on a reference element of kDim dimensions.
template <int kDim>
struct RulePoint {
  Eigen::Matrix<double, kDim, 1> xi;
  double weight = 0.0;  ///< The weights sum to the size of the reference element.
};

template <int kDim, std::size_t kCount>
using Rule = std::array<RulePoint<kDim>, kCount>;

/// A point of a rule, with the shape functions there.
template <int kNodes, int kDim = 3>
struct QuadraturePoint {
  double weight = 0.0;                 ///< As in the rule.
  Eigen::Matrix<double, kNodes, 1> N;  ///< Value of each shape function.
  Eigen::Matrix<double, kDim, kNodes>
      dN_dxi;  ///< Column a: gradient of N_a in reference coordinates.
};

/// \returns `rule` with the shape functions of `Shape` and their gradients at each point.
template <class Shape, int kDim, std::size_t kCount>
[[nodiscard]] std::array<QuadraturePoint<Shape::kNodes, kDim>, kCount> at_points(
    const Rule<kDim, kCount>& rule) {
  std::array<QuadraturePoint<Shape::kNodes, kDim>, kCount> points;
  for (std::size_t q = 0; q < kCount; ++q)
    points[q] = {.weight = rule[q].weight,
                 .N = Shape::functions(rule[q].xi),
                 .dN_dxi = Shape::gradients(rule[q].xi)};
  return points;
}

}  // namespace lefort::fem
