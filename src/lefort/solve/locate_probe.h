/// \file
/// Where in the mesh a probe is: the nodes whose displacements make up its own.
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
  std::vector<double> weights;  ///< One per node: the shape functions there; their sum is 1.
};

/// \param at  a node of an element, or a point of the body at rest, in L.
/// \returns its place, or kPlanInvalid: there is no such node, or the point lies in no element; the
///   nearest node is told.
/// \note A point on a face belongs to the element it lies deepest in, of equals to the first.
[[nodiscard]] Result<ProbePlace> locate_probe(const mesh::VolumeMesh& mesh,
                                              const std::variant<std::int32_t, Vec3>& at);

/// \param u  displacements of all nodes, 3 per node [mm].
[[nodiscard]] Vec3 displacement_of(const ProbePlace& probe, const VectorX& u);

}  // namespace lefort::solve
