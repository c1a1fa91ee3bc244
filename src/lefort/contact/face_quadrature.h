/// \file
/// Quadrature of the contact potential over a face of the tissue.
#pragma once

#include <lefort/core/types.h>
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

/// Quadrature rule of one face shape.
struct FaceQuadrature {
  std::vector<QuadraturePoint> points;
  /// Max of sum_a |N_a|: no point moves further than this times the largest nodal displacement.
  double displacement_bound = 1.0;
};

/// Max number of points of a rule.
inline constexpr std::size_t kMaxPoints = 9;

/// Number of the rule of a single node.
inline constexpr std::uint8_t kNodeRule = 4;

/// \param number  of a mesh::FaceShape, or kNodeRule.
[[nodiscard]] const FaceQuadrature& face_quadrature(std::size_t number);

/// Fraction of the area of a face that is lumped at its a-th node. A face with mid-edge nodes is
/// divided into triangles (face_division()). All fractions are positive, and the sum of the lumped
/// forces is exact for a pressure that varies linearly.
[[nodiscard]] double lumped_weight(mesh::FaceShape shape, std::size_t a);

/// \param x_L  nodes of the face [mm].
/// \returns the position of a point of the face.
[[nodiscard]] Vec3 interpolate(const QuadraturePoint& point, std::span<const Vec3> x_L);

/// \param x_L  nodes of the face [mm].
/// \returns the area that a point stands for: its weight times the area element [mm^2].
[[nodiscard]] double area_mm2(const QuadraturePoint& point, std::span<const Vec3> x_L);

}  // namespace lefort::contact
