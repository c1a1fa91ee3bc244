/// \file
/// Fills the inside of a level function with tetrahedra.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/mesh/volume_mesh.h>

#include <functional>

namespace lefort::mesh {

/// How fine and how well shaped the tetrahedra are.
struct TetOptions {
  double element_size_mm = 3.0;  ///< Circumradius bound of elements and boundary faces, > 0.
  /// If given, replaces element_size_mm where it is smaller; takes points in L, gives mm > 0.
  std::function<double(const Vec3&)> size_at_mm = {};
  double surface_distance_mm = 0.4;  ///< Largest gap between a boundary face and the level, > 0.
  double facet_angle_deg = 25.0;     ///< Smallest angle of boundary faces, 0 to 30.
  double cell_radius_edge = 2.5;     ///< Circumradius over shortest edge, >= 2.
  double sliver_angle_deg = 15.0;    ///< Smallest dihedral angle that is aimed at, 0 to 20.
  /// Scaled; elements below it lose an edge (mesh/collapse_edges.h) where that betters them, 0 to
  /// 0.5; with 0 all stay.
  double min_scaled_jacobian = 0.0;
  double level_tolerance_mm = 0.01;  ///< How far boundary nodes may lie off the level, > 0.
};

/// Meshes {p : level_L(p) > 0} within a box.
///
/// \param level_L   positive inside, negative outside, continuous; called from one thread, must
///   give the same value for the same point. NaN counts as outside.
/// \param box_L     the region looked at; where the level is positive on its border the mesh ends
///   there.
/// \returns one block of tetrahedra (region 0) with positive volumes, connected through faces and
///   without hinges (mesh/largest_face_connected_part.h), every node in use, boundary nodes within
///   options.level_tolerance_mm of where the inside ends, except those few that would squash an
///   element on their way there; or
///   - kInvalidArgument  an option or the box lies outside its range;
///   - kMeshingFailed    the level is nowhere positive, no valid mesh came out, the memory is too
///                       small, or more than 5 % of the volume hang together with the largest part
///                       in no face (less is left out, and told as a note);
///   - kCancelled        `progress` asked to stop.
/// \note Keeps the largest connected part alone. Same input, same bytes, on one machine.
/// \note Delaunay refinement, sliver perturbation and exudation \cite cgal:rty-m3, then the rest of
///   the slivers by moving nodes (mesh/improve_tets.h): a few elements may stay below the angle.
[[nodiscard]] Result<VolumeMesh> generate_tets(const std::function<double(const Vec3&)>& level_L,
                                               const Box3& box_L, const TetOptions& options = {},
                                               Progress& progress = Progress::none());

}  // namespace lefort::mesh
