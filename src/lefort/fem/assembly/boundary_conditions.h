/// \file
/// Prescribed displacements.
#pragma once

#include <lefort/core/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::fem {

/// One prescribed displacement component of one node.
struct PrescribedDisplacement {
  std::int32_t node = 0;
  int component = 0;             ///< 0, 1, 2 for x, y, z of L.
  double displacement_mm = 0.0;  ///< From the reference position.
};

/// \param nodes  numbers of the nodes.
/// \returns zero displacement of all components of `nodes`.
[[nodiscard]] std::vector<PrescribedDisplacement> prescribe_zero(
    std::span<const std::int32_t> nodes);

/// \param nodes      numbers of the nodes.
/// \param nodes_L    reference positions of all nodes of the mesh [mm].
/// \param motion_LL  maps a reference position to the current position, both in L.
/// \returns the displacements of all components of `nodes` by the rigid motion.
[[nodiscard]] std::vector<PrescribedDisplacement> prescribe_rigid_motion(
    std::span<const std::int32_t> nodes, std::span<const Vec3> nodes_L,
    const RigidTransform& motion_LL);

}  // namespace lefort::fem
