/// \file
/// Quantities that are linear in the position and determine the distance to a triangle.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/closest_point.h>

#include <algorithm>
#include <array>

namespace lefort::field {

/// Height w above the plane of a triangle, and for each edge i of length L_i the in-plane
/// coordinates q_i along it and r_i outward from it.
///
/// The squared distance is w^2 if the triangle has area and all r_i <= 0, otherwise
/// w^2 + min_i (r_i^2 + t_i^2), where t_i is the distance of q_i from the interval [0, L_i].
struct TriangleFrame {
  std::array<Vec3, 3> corners;  ///< Edge i begins at corner i.
  std::array<double, 3> length;
  std::array<Vec3, 3> along;    ///< Unit vectors along the edges.
  std::array<Vec3, 3> outward;  ///< Unit vectors normal to the edges, in the plane.
  Vec3 normal;                  ///< Unit vector.
  bool has_area;
};

/// Shorter edges count as points: their squares underflow, so they have no usable direction.
inline constexpr double kNoLength_mm = 1e-150;

/// The frame of the triangle (a, b, c). A triangle without area is replaced by its longest edge,
/// three times; if all edges are shorter than kNoLength_mm, by its corner.
[[nodiscard]] inline TriangleFrame triangle_frame(const Vec3& a, const Vec3& b, const Vec3& c) {
  TriangleFrame frame;
  frame.corners = {a, b, c};
  frame.has_area = !geometry::triangle_is_degenerate(a, b, c);
  for (std::size_t i = 0; i < 3; ++i) {
    frame.along[i] = frame.corners[(i + 1) % 3] - frame.corners[i];
    frame.length[i] = frame.along[i].norm();
    if (frame.length[i] >= kNoLength_mm) {
      frame.along[i] /= frame.length[i];
    } else {
      frame.length[i] = 0.0;
      frame.along[i] = Vec3::UnitX();
    }
  }
  if (frame.has_area) {
    frame.normal = (b - a).cross(c - a).normalized();
  } else {
    const auto longest = std::size_t(std::max_element(frame.length.begin(), frame.length.end()) -
                                     frame.length.begin());
    frame.corners.fill(Vec3(frame.corners[longest]));
    frame.along.fill(Vec3(frame.along[longest]));
    frame.length.fill(double(frame.length[longest]));
    frame.normal = frame.along[0].unitOrthogonal();
  }
  for (std::size_t i = 0; i < 3; ++i) frame.outward[i] = frame.along[i].cross(frame.normal);
  return frame;
}

}  // namespace lefort::field
