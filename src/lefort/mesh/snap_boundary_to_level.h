/// \file
/// Snaps the boundary nodes of a tetrahedral mesh to the surface of the tissue.
#pragma once

#include <lefort/mesh/find_zero_crossing.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::mesh {

/// Moves each boundary node along the boundary normal to where `is_inside_L` changes. If the move
/// would reduce the volume of an element to less than a fifth, the node moves half of the way, a
/// quarter of it, or not at all, so that no element is inverted.
///
/// \param mesh             one block of kTet4 with positive volumes.
/// \param is_inside_L      the tissue.
/// \param max_distance_mm  max displacement; if `is_inside_L` does not change within it, the node
///   does not move.
/// \param tolerance_mm     largest distance from the surface after the move.
/// \returns the number of nodes that did not move all the way, because of an element volume.
Index snap_boundary_to_level(VolumeMesh& mesh, const InsidePredicate& is_inside_L,
                             double max_distance_mm, double tolerance_mm);

}  // namespace lefort::mesh
