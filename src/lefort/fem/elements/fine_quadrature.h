/// \file
/// Quadrature of higher order than that of the strain energy: for error norms, and for loads that
/// vary inside an element.
///
/// Products of Gauss and Gauss-Jacobi rules with four points each; conical products
/// (\cite stroud1971) for triangles, tetrahedra and pyramids. They are exact to degree 7 on every
/// shape and have 64 points in an element, 16 on a face. To leading order the squared error of a
/// quadratic displacement has degree 6.
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::fem {

inline constexpr int kFineDegree = 7;

/// \returns the rule on the reference element of this shape.
[[nodiscard]] std::vector<RulePoint<3>> fine_rule(mesh::ElementShape shape);
[[nodiscard]] std::vector<RulePoint<2>> fine_rule(mesh::FaceShape shape);

/// \returns the rule with shape functions: a substitute for Shape::quadrature().
template <class Shape>
[[nodiscard]] auto fine_quadrature() {
  const auto rule = fine_rule(Shape::kShape);
  constexpr int kDim = int(decltype(rule[0].xi)::RowsAtCompileTime);
  std::vector<QuadraturePoint<Shape::kNodes, kDim>> points;
  points.reserve(rule.size());
  for (const RulePoint<kDim>& point : rule)
    points.push_back({.weight = point.weight,
                      .N = Shape::functions(point.xi),
                      .dN_dxi = Shape::gradients(point.xi)});
  return points;
}

}  // namespace lefort::fem
