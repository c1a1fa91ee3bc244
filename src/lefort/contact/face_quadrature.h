/// \file
/// The points of a face of tissue at which contact asks for its gap, and what each stands for.
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

/// A point of a reference face.
struct QuadraturePoint {
  double weight = 0.0;
  std::array<double, kMaxFaceNodes> N{};
  Eigen::Matrix<double, 2, kMaxFaceNodes> dN_dxi = Eigen::Matrix<double, 2, kMaxFaceNodes>::Zero();
};

/// Where a face of one shape is asked for its gap.
struct FaceQuadrature {
  std::vector<QuadraturePoint> points;
  double reach = 1.0;  ///< How much further a point may move than the nodes do, at most.
};

/// Of points in a rule, at most.
inline constexpr std::size_t kMaxPoints = 9;

/// \param number  of a FaceShape; kNodeRule for a node alone.
inline constexpr std::uint8_t kNodeRule = 4;
[[nodiscard]] const FaceQuadrature& face_quadrature(std::size_t number);

/// The part of a face that its a-th node stands for: that of a corner in the face, or in the
/// smaller ones that middle nodes cut it into. All positive, and exact for forces that vary
/// linearly.
[[nodiscard]] double lumped_weight(mesh::FaceShape shape, std::size_t a);

/// Where a point is, the nodes of its face being at x.
[[nodiscard]] Vec3 interpolate(const QuadraturePoint& point, std::span<const Vec3> x_L);

/// The area a point stands for.
[[nodiscard]] double area_mm2(const QuadraturePoint& point, std::span<const Vec3> x_L);

}  // namespace lefort::contact
