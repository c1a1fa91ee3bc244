/// \file
/// More points than the strain energy needs: for error norms, masses and loads that vary inside an
/// element.
///
/// Conical products of Gauss-Jacobi rules with four points each \cite stroud1971, exact to degree 7
/// on every shape: 64 points in an element, 16 on a face. The squared error of a quadratic
/// displacement, of degree 6, is among what they integrate.
#pragma once

#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::fem {

inline constexpr int kFineDegree = 7;

/// On the reference element of that shape.
[[nodiscard]] std::vector<RulePoint<3>> fine_rule(mesh::ElementShape shape);
[[nodiscard]] std::vector<RulePoint<2>> fine_rule(mesh::FaceShape shape);

/// The same with the shape functions: in the place of Shape::quadrature().
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
