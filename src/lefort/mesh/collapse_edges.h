/// \file
/// Removes tetrahedra of low quality by edge collapse.
#pragma once

#include <lefort/mesh/volume_mesh.h>

namespace lefort::mesh {

/// Collapses one edge of each element whose scaled Jacobian is below `min_scaled_jacobian`,
/// starting with the worst: one end node is merged into the other, and the elements around the edge
/// vanish.
///
/// An edge is collapsed only if
/// - the topology does not change (link condition, \cite dey1999);
/// - boundary faces rotate by at most 25 degrees, and boundary nodes stay on the boundary;
/// - the lowest scaled Jacobian of the changed elements increases.
/// Among the edges of an element whose collapse leaves a quality of `min_scaled_jacobian` or more,
/// the one that rotates the boundary least is collapsed; if there is none, the one that leaves the
/// highest quality.
///
/// \param mesh                 one block of kTet4 with positive volumes, without sets and hinges
///   (mesh/largest_face_connected_part.h). Unused nodes are removed, the others keep their order
///   and position.
/// \param min_scaled_jacobian  quality below which an edge of an element is collapsed.
/// \returns the number of collapsed edges.
Index collapse_edges(VolumeMesh& mesh, double min_scaled_jacobian);

}  // namespace lefort::mesh
