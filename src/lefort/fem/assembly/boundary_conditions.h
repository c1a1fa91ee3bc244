/// \file
/// Prescribed displacements: what is held, and what moves with something else.
#pragma once

#include <lefort/core/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::fem {

/// One displacement component of one node that is given, not solved for.
struct PrescribedDisplacement {
  std::int32_t node = 0;
  int component = 0;             ///< 0, 1, 2 for x, y, z of L.
  double displacement_mm = 0.0;  ///< From the reference position.
};

/// Holds all components of `nodes` at their reference position.
[[nodiscard]] std::vector<PrescribedDisplacement> prescribe_zero(
    std::span<const std::int32_t> nodes);

/// Moves all components of `nodes` with a rigid body.
///
/// \param nodes      numbers of the nodes that move.
/// \param nodes_L    reference positions of all nodes of the mesh [mm].
/// \param motion_LL  takes a reference position to where the body has brought it, both in L.
[[nodiscard]] std::vector<PrescribedDisplacement> prescribe_rigid_motion(
    std::span<const std::int32_t> nodes, std::span<const Vec3> nodes_L,
    const RigidTransform& motion_LL);

}  // namespace lefort::fem
