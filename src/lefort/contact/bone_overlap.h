/// \file
/// Overlap of two bones, measured before the solve.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <vector>

namespace lefort::contact {

/// A bone: its surface and its distance query in its own frame, and its pose.
struct SolidBone {
  const geometry::TriangleMesh* surface_B = nullptr;  ///< Closed. Not owned.
  RigidObstacle obstacle;
};

/// Overlap of a first and a second bone.
struct BoneOverlap {
  double volume_mm3 = 0.0;            ///< Common to both bones.
  double deepest_mm = 0.0;            ///< 0 without overlap; limited by the range of the query.
  Vec3 deepest_L = Vec3::Zero();      ///< Position of the deepest point [mm].
  bool depth_is_lower_bound = false;  ///< A point lies deeper than the range of the query.
  /// Depth of each vertex of the first bone in the second; 0 if at most kTouching_mm.
  std::vector<double> depth_mm;
  std::vector<double> depth_of_second_mm;  ///< The same of the second bone in the first.

  [[nodiscard]] bool overlaps() const { return deepest_mm > 0.0; }
};

/// Overlap up to this depth counts as touching. The two sides of a cut touch, and a sampled field
/// has errors of this size.
inline constexpr double kTouching_mm = 0.1;

/// Tests the vertices and edges of each bone against the other. Edges are sampled, so that a thin
/// wall pierced by a long triangle is found.
///
/// The volume is counted on a lattice of at most about a million points, in the bounding box of all
/// points that do more than touch, enlarged by the edge spacing. A point deeper than the range of
/// the distance query has the range as depth.
/// \param moved            first bone; \pre its surface is not null.
/// \param stationary       second bone; \pre its surface is not null.
/// \param edge_spacing_mm  max distance between the samples of an edge, > 0.
/// \note Cost: one query per vertex and per sample of an edge in the bounding box of the other bone
///   if that is closed, and two per lattice point.
[[nodiscard]] BoneOverlap measure_overlap(const SolidBone& moved, const SolidBone& stationary,
                                          double edge_spacing_mm);

}  // namespace lefort::contact
