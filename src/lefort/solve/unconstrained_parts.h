/// \file
/// Finds what would make the equations singular before they are solved: parts of the body that
/// nothing keeps from moving as a whole.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lefort::solve {

/// Elements that hang together, and can move as one.
struct UnconstrainedPart {
  Index first_element = 0;   ///< Through the blocks.
  Vec3 at_L = Vec3::Zero();  ///< Center of that element [mm].
  Index elements = 0;
  std::vector<std::int32_t> nodes;  ///< Ascending.
  int free_motions = 0;             ///< Of the six of a rigid body, how many.
  std::string motion;               ///< One of them in words: "move along (0, 0, 1)".
};

/// Parts connected by common nodes whose prescribed components leave a rigid motion free.
///
/// \param mesh  elements name nodes that exist.
/// \note Parts that hang by one node or one edge count as connected; they are told only by the
///   solver (find_weakest_mode.h).
[[nodiscard]] std::vector<UnconstrainedPart> find_unconstrained_parts(
    const mesh::VolumeMesh& mesh, std::span<const fem::PrescribedDisplacement> prescribed);

}  // namespace lefort::solve
