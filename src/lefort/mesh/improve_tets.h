/// \file
/// Improves the quality of the worst tetrahedra of a mesh by moving their nodes.
#pragma once

#include <lefort/mesh/find_zero_crossing.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>

namespace lefort::mesh {

/// An element is improved if its smallest dihedral angle is below angle_deg, its largest exceeds
/// 180 - angle_deg, or 3 r / R < sin(angle_deg) / 2, with inradius r and circumradius R.
struct ImproveOptions {
  double angle_deg = 15.0;      ///< 0 to 20.
  int sweeps = 12;              ///< Largest number of passes over the elements.
  double tolerance_mm = 0.001;  ///< Max distance of boundary nodes from the surface.
  bool with_jacobian = false;   ///< Improve scaled Jacobians below sin(angle_deg) / 2, too.
  std::span<const char> fixed_nodes = {};  ///< Not 0 for fixed nodes; empty, or one per node.
};

/// Moves the nodes of the elements that ImproveOptions describes, one by one, to the position that
/// maximizes the lowest quality of the elements around the node (pattern search). The connectivity
/// does not change.
///
/// Interior nodes move freely; boundary nodes move along the boundary and are then snapped to where
/// `is_inside_L` changes. No move rotates a boundary face by more than 20 degrees, so that ridges
/// are preserved. Volumes stay positive.
///
/// \param mesh         one block of kTet4.
/// \param is_inside_L  the tissue; used for boundary nodes that are not fixed.
/// \param options      which elements are improved.
/// \returns the number of elements that are still below the target.
Index improve_tets(VolumeMesh& mesh, const InsidePredicate& is_inside_L,
                   const ImproveOptions& options = {});

}  // namespace lefort::mesh
