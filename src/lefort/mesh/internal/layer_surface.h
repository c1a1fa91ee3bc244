/// \file
/// The triangles that a boundary layer covers, before any node is moved.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/internal/users_of_nodes.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstddef>
#include <vector>

namespace lefort::mesh::internal {

/// The covered part of the boundary of a tetrahedral mesh.
struct LayerSurface {
  std::vector<Vec3> nodes_L;  ///< All nodes of the mesh in the reference configuration [mm].
  std::vector<Face3> faces;   ///< Covered triangles, counter-clockwise seen from outside.
  Lists faces_of_node;        ///< Indices into `faces`, one list per node of the mesh.

  /// \returns the outward normal of a face, of the length of its area [mm^2].
  [[nodiscard]] Vec3 area_vector(Index face) const {
    const auto& [a, b, c] = faces[std::size_t(face)];
    const Vec3& p = nodes_L[std::size_t(a)];
    return 0.5 * (nodes_L[std::size_t(b)] - p).cross(nodes_L[std::size_t(c)] - p);
  }
};

}  // namespace lefort::mesh::internal
