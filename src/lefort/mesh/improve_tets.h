/// \file
/// Makes the worst-shaped tetrahedra of a mesh better by moving their nodes.
#pragma once

#include <lefort/mesh/find_zero_crossing.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>

namespace lefort::mesh {

/// Bad is an element with a dihedral angle below angle_deg or above 180 less that, or as flat
/// otherwise: 3 inradius / circumradius below half the sine of that angle.
struct ImproveOptions {
  double angle_deg = 15.0;      ///< 0 to 20.
  int sweeps = 12;              ///< How often all bad elements are looked at.
  double tolerance_mm = 0.001;  ///< How near boundary nodes stay to where the inside ends.
  bool with_jacobian = false;   ///< Bad, too, are scaled Jacobians below half the sine.
  std::span<const char> fixed_nodes = {};  ///< Not 0 for nodes that stay; empty, or one per node.
};

/// Moves the nodes of bad elements, one after another, to where the worst element around the node
/// is best. Connections stay.
///
/// Inner nodes move freely; nodes of the boundary along it, and then to where `is_inside_L`
/// changes. A face of the boundary never turns by more than 20 degrees at once, so ridges stay.
///
/// \returns how many elements are still bad.
/// \pre One block of kTet4; volumes that are positive stay so.
Index improve_tets(VolumeMesh& mesh, const InsidePredicate& is_inside_L,
                   const ImproveOptions& options = {});

}  // namespace lefort::mesh
