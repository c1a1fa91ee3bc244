/// \file
/// Puts the boundary nodes of a tetrahedral mesh where the inside ends.
#pragma once

#include <lefort/mesh/find_zero_crossing.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::mesh {

/// Moves each boundary node along the boundary's normal to where `is_inside_L` changes.
///
/// \param reach_mm   a node is not moved further; without a change within reach it stays.
/// \param tolerance_mm   nodes this near stay, others come this near.
/// \returns the nodes that would have squashed an element below a fifth of its volume on the way:
///   they went half the way, a quarter, or stay, so that no element is inverted.
/// \pre Blocks of kTet4 with positive volumes.
Index snap_boundary_to_level(VolumeMesh& mesh, const InsidePredicate& is_inside_L, double reach_mm,
                             double tolerance_mm);

}  // namespace lefort::mesh
