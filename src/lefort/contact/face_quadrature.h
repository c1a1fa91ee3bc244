/// \file
/// Quadrature of the contact potential over a face of the tissue.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/elements/quadrature_point.h>
#include <lefort/mesh/element_faces.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::contact {

inline constexpr std::size_t kMaxFaceNodes = 8;

/// A point of the reference face, with weight, shape functions and their derivatives.
struct QuadraturePoint {
  double weight = 0.0;
  std::array<double, kMaxFaceNodes> N{};
  Eigen::Matrix<double, 2, kMaxFaceNodes> dN_dxi = Eigen::Matrix<double, 2, kMaxFaceNodes>::Zero();
};

/// \param known  points of fem/elements/quadrature_rules.h.
/// \returns the points with the shape functions of `Shape`.
template <class Shape, class Rule>
[[nodiscard]] std::vector<QuadraturePoint> quadrature_points(const Rule& known) {
  std::vector<QuadraturePoint> points;
  for (const auto& at : fem::at_points<Shape>(known)) {
    QuadraturePoint& point = points.emplace_back();
    point.weight = at.weight;
    for (int a = 0; a < Shape::kNodes; ++a) point.N[std::size_t(a)] = at.N[a];
    point.dN_dxi.template leftCols<Shape::kNodes>() = at.dN_dxi;
  }
  return points;
}

/// Quadrature rule of one face shape.
struct FaceQuadrature {
  std::vector<QuadraturePoint> points;
  /// Max of sum_a |N_a|: no point moves further than this times the largest nodal displacement.
  double displacement_bound = 1.0;
};

/// Max number of points of a rule.
inline constexpr std::size_t kMaxPoints = 12;

/// \param number  of a mesh::FaceShape.
[[nodiscard]] const FaceQuadrature& face_quadrature(std::size_t number);

/// \param x_L  nodes of the face [mm].
/// \returns the position of a point of the face.
[[nodiscard]] Vec3 interpolate(const QuadraturePoint& point, std::span<const Vec3> x_L);

/// \param x_L  nodes of the face [mm].
/// \returns the area that a point stands for: its weight times the area element [mm^2].
[[nodiscard]] double area_mm2(const QuadraturePoint& point, std::span<const Vec3> x_L);

}  // namespace lefort::contact
