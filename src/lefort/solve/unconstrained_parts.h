/// \file
/// Finds parts of the body that can move as a rigid body and make the equations singular.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lefort::solve {

/// Connected elements that can move as a rigid body.
struct UnconstrainedPart {
  Index first_element = 0;   ///< Number through the blocks.
  Vec3 at_L = Vec3::Zero();  ///< Center of that element [mm].
  Index elements = 0;
  std::vector<std::int32_t> nodes;  ///< Ascending.
  int free_motions = 0;             ///< Number of free rigid-body modes, 1 to 6.
  std::string motion;               ///< One of these modes as text: "move along (0, 0, 1)".
};

/// Finds the parts, connected by common nodes, whose prescribed components do not prevent every
/// rigid motion.
///
/// \param mesh        nodes of elements exist.
/// \param prescribed  displacements of nodes.
/// \note Parts that share only a node or an edge count as connected, although they can rotate about
///   it. find_weakest_mode() finds such motions.
[[nodiscard]] std::vector<UnconstrainedPart> find_unconstrained_parts(
    const mesh::VolumeMesh& mesh, std::span<const fem::PrescribedDisplacement> prescribed);

}  // namespace lefort::solve
