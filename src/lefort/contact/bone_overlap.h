/// \file
/// Where one bone has been moved into another: told before anything is solved.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <vector>

namespace lefort::contact {

/// A bone's surface and who tells how far points are from it, both in its own frame.
struct SolidBone {
  const geometry::TriangleMesh* surface_B = nullptr;  ///< Closed. Not owned.
  RigidObstacle obstacle;
};

/// Where two bones are in each other.
struct BoneOverlap {
  double volume_mm3 = 0.0;
  double deepest_mm = 0.0;            ///< 0 if they do not overlap; at most a detector's reach.
  Vec3 deepest_L = Vec3::Zero();      ///< Where that is.
  bool depth_is_lower_bound = false;  ///< Somewhere deeper than a detector can tell.
  std::vector<double> depth_mm;  ///< Of each vertex of the first bone in the second; 0 outside.
  std::vector<double> depth_of_second_mm;  ///< The other way round.

  [[nodiscard]] bool overlaps() const { return deepest_mm > 0.0; }
};

/// Bones that are less deep in each other touch: what was one bone before a cut, and what is lost
/// between the samples of a field.
inline constexpr double kTouching_mm = 0.1;

/// Looks for the vertices and edges of each bone in the other: edges at points no further apart
/// than `edge_spacing_mm`, so that a thin wall which a long triangle cuts is noticed.
///
/// The volume is counted on a fine lattice, in the box of all that does more than touch. A
/// bone that is wholly inside the other beyond its detector's reach counts as that deep.
/// \param edge_spacing_mm  > 0.
/// \note Cost: a query per vertex, and per edge spacing; a million or so for the volume.
[[nodiscard]] BoneOverlap measure_overlap(const SolidBone& moved, const SolidBone& stationary,
                                          double edge_spacing_mm);

}  // namespace lefort::contact
