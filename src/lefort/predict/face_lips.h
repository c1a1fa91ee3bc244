/// \file
/// Finds the point of the other lip that each node of a lip faces, after the lips have slipped on
/// each other.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/separate_lips.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::predict {

/// A node of a lip, and the point of the other lip that it faces. Their opening is
/// normal_L . (x_0 - sum_i weights_i x_i) - rest_mm, with the positions x of `nodes`.
struct FacingPoint {
  std::array<std::int32_t, 4> nodes{};  ///< The node, then a triangle of the other lip.
  Vec3 weights = Vec3::UnitX();         ///< Of the corners of the triangle; their sum is 1.
  Vec3 normal_L = Vec3::UnitZ();        ///< Unit length, from the other lip to the node.
  double rest_mm = 0.0;                 ///< Distance along normal_L at which the lips touch.
  double area_mm2 = 0.0;                ///< Of this point: half of that of its pair.
};

/// The surface of one lip in the slit. With each node moves the point of the surface in which the
/// lips touch at rest (OralFissure::level), which the mesh meets to a part of an element only: a
/// serrated slit would hinder slip.
struct LipSurface {
  std::vector<std::int32_t> nodes;            ///< Of the tissue, ascending.
  std::vector<geometry::Triangle> triangles;  ///< Positions in `nodes`; outward.
  std::vector<double> heights_mm;             ///< Of the nodes above the surface of contact.
  double outward = 1.0;                       ///< -1: its outward side is inferior (upper lip).
};

/// \param tissue  with the sets kUpperLip and kLowerLip.
/// \param lips    separated.
/// \returns upper and lower lip.
[[nodiscard]] std::array<LipSurface, 2> lip_surfaces(const mesh::VolumeMesh& tissue,
                                                     const LipSlit& lips);

/// Pairs both nodes of each pair with the closest point of the other lip: node to surface in two
/// half passes, each with half the area (\cite sauer2015).
///
/// \param surfaces  upper and lower lip.
/// \param pairs     at rest.
/// \param x_L       positions of all nodes of the tissue [mm].
/// \returns in the order of the pairs, upper node first; without the nodes that have slipped beyond
///   the border of the other lip, and those that belong to both lips.
[[nodiscard]] std::vector<FacingPoint> face_lips(const std::array<LipSurface, 2>& surfaces,
                                                 std::span<const LipPair> pairs,
                                                 std::span<const Vec3> x_L);

/// \param x_L  positions of `point.nodes` [mm].
/// \returns the opening; negative if the lips overlap.
[[nodiscard]] inline double opening_mm(const FacingPoint& point, std::span<const Vec3> x_L) {
  const Vec3 faced =
      point.weights[0] * x_L[1] + point.weights[1] * x_L[2] + point.weights[2] * x_L[3];
  return point.normal_L.dot(x_L[0] - faced) - point.rest_mm;
}

}  // namespace lefort::predict
