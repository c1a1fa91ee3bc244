/// \file
/// The closest point of a triangle to a given point, and the feature it lies on.
#pragma once

#include <lefort/core/types.h>

#include <cstdint>

namespace lefort::geometry {

/// Part of a triangle. Edge i runs from corner i to corner (i + 1) % 3.
///
///          2
///         / \        The closest point lies inside the face, strictly inside an edge, or on a
///  edge2 /   \ edge1 corner: the seven Voronoi regions of a triangle.
///       /_____\      .
///      0 edge0 1
enum class Feature : std::uint8_t { kFace, kEdge0, kEdge1, kEdge2, kVertex0, kVertex1, kVertex2 };

[[nodiscard]] constexpr bool is_edge(Feature f) {
  return f >= Feature::kEdge0 && f <= Feature::kEdge2;
}
[[nodiscard]] constexpr bool is_vertex(Feature f) { return f >= Feature::kVertex0; }

/// Number 0, 1, 2 of the edge or corner; 0 for the face.
[[nodiscard]] constexpr int number_of(Feature f) {
  return is_vertex(f) ? int(f) - int(Feature::kVertex0) : is_edge(f) ? int(f) - 1 : 0;
}

/// Closest point of a triangle.
struct TrianglePoint {
  Vec3 point;
  double squared_distance_mm2;
  Feature feature;
};

/// Finds the closest point of the triangle (a, b, c) by its Voronoi regions (Ericson 2005, 5.1.5).
///
/// A triangle without area (`triangle_is_degenerate`) is treated as its three edges, one without
/// length as a point. Finite input gives finite output.
///
/// \param p        query point.
/// \param a, b, c  corners of the triangle.
[[nodiscard]] TrianglePoint closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                                      const Vec3& c);

/// Triangles whose height is at most this fraction of their longest edge have no usable normal:
/// rounding of coordinates may reverse the normal. Their edges represent them to the same accuracy.
inline constexpr double kDegenerateHeightRatio = 1e-7;

/// True if the height of the triangle (a, b, c) is at most kDegenerateHeightRatio times its longest
/// edge.
[[nodiscard]] bool triangle_is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace lefort::geometry
