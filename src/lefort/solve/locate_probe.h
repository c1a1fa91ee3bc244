/// \file
/// Finds the nodes and weights that give the displacement of a probe.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <variant>
#include <vector>

namespace lefort::solve {

/// A material point as a weighted mean of nodes.
struct ProbePlace {
  Vec3 at_L = Vec3::Zero();  ///< At rest [mm].
  std::vector<std::int32_t> nodes;
  std::vector<double> weights;  ///< Shape functions, one per node; their sum is 1.
};

/// \param mesh  the body at rest.
/// \param at    a node of an element, or a point of the body at rest, in L.
/// \returns the nodes and weights; or kPlanInvalid: no element has this node, or the point lies in
///   no element, in which case the message names the closest node.
/// \note A point on a face belongs to the element in which it lies deepest; in a tie, to the first.
[[nodiscard]] Result<ProbePlace> locate_probe(const mesh::VolumeMesh& mesh,
                                              const std::variant<std::int32_t, Vec3>& at);

/// \param probe  from locate_probe().
/// \param u      displacements of all nodes, 3 per node [mm].
[[nodiscard]] Vec3 displacement_of(const ProbePlace& probe, const VectorX& u);

}  // namespace lefort::solve
