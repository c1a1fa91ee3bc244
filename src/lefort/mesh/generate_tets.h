/// \file
/// Generates tetrahedra in the region where a level-set function is positive.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/mesh/volume_mesh.h>

#include <functional>

namespace lefort::mesh {

/// Size and quality of the tetrahedra.
struct TetOptions {
  /// Circumradius bound of elements and boundary faces: from the edge of a cube of 1 / 3e7 of the
  /// box volume to the longest edge of the box.
  double element_size_mm = 3.0;
  /// If set, replaces element_size_mm where it is smaller; maps points in L to mm > 0. Values below
  /// 0.02 element_size_mm count as 0.02 element_size_mm.
  std::function<double(const Vec3&)> size_at_mm = {};
  /// Largest distance of a boundary face from the surface, >= 0.001 element_size_mm.
  double surface_distance_mm = 0.4;
  double facet_angle_deg = 25.0;   ///< Smallest angle of boundary faces, 0 to 30.
  double cell_radius_edge = 2.5;   ///< Largest circumradius over shortest edge, 2 to 100.
  double sliver_angle_deg = 15.0;  ///< Target of the smallest dihedral angle, 0 to 20.
  /// In elements with a smaller scaled Jacobian, an edge is collapsed (mesh/collapse_edges.h) if
  /// this improves the quality; 0 to 0.5; 0: no collapse.
  double min_scaled_jacobian = 0.0;
  double level_tolerance_mm = 0.01;  ///< Max distance of boundary nodes from the surface, >= 1e-6.
};

/// Meshes {p : level_set_L(p) > 0} within a box: Delaunay refinement, sliver perturbation and
/// exudation \cite cgal:rty-m3, then optimization of node positions (mesh/improve_tets.h). A few
/// elements may stay below the sliver angle.
///
/// \param level_set_L  level-set function of a point in L [mm]: positive inside, negative outside,
///   continuous; called from one thread, must return the same value for the same point. NaN counts
///   as outside.
/// \param box_L        the region to be meshed [mm], within 1e5 mm of the origin along each axis.
///   Where the level is positive on sides of the box, the mesh ends at these sides.
/// \param options      size and quality.
/// \param progress     receives the fraction done and notes; may request a stop.
/// \returns one block of tetrahedra (region 0) with positive volumes: the largest part that is
///   connected through faces, also around each edge and node (mesh/largest_face_connected_part.h).
///   Every node is used. Boundary nodes lie within options.level_tolerance_mm of the surface,
///   except the few whose motion to it would flatten an element. Or
///   - kInvalidArgument  an option or the box lies outside its range;
///   - kMeshingFailed    the level is nowhere positive; there is no valid mesh; the mesh would have
///                       more than 4e6 nodes; memory is exhausted; or more than 5 % of the volume
///                       is not connected to the largest part through faces (less is omitted, and
///                       reported as a note);
///   - kCancelled        `progress` requested a stop.
/// \note The same input gives the same bits on one machine.
[[nodiscard]] Result<VolumeMesh> generate_tets(
    const std::function<double(const Vec3&)>& level_set_L, const Box3& box_L,
    const TetOptions& options = {}, Progress& progress = Progress::none());

}  // namespace lefort::mesh
