/// \file
/// A triangle as the lattice sees it: all that its distance needs is linear in the position.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/closest_point.h>

#include <algorithm>
#include <array>

namespace lefort::field {

/// Height w over a triangle's plane, and for each side i of length L_i the coordinates q_i along it
/// and r_i outward from it, in the plane.
///
/// The squared distance is w^2 where all r_i <= 0, and elsewhere w^2 + min_i (r_i^2 + t_i^2), t_i
/// being how far q_i lies outside of [0, L_i].
struct TriangleFrame {
  std::array<Vec3, 3> corners;  ///< Side i begins at corner i.
  std::array<double, 3> length;
  std::array<Vec3, 3> along;    ///< Unit.
  std::array<Vec3, 3> outward;  ///< Unit.
  Vec3 normal;                  ///< Unit.
  bool has_area;
};

/// Shorter sides have none: squares underflow, and what is left has no direction.
inline constexpr double kNoLength_mm = 1e-150;

/// A triangle without area is taken as its longest side, three times: that is all of it. One
/// whose sides all are shorter than kNoLength_mm is taken as its corner.
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
