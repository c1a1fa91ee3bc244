/// \file
/// Area and normal of each node of the tissue boundary.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::predict {

/// Of a node; zero for nodes inside the mesh.
struct BoundaryNode {
  double area_mm2 = 0.0;  ///< A third of each adjacent triangle; quadratic faces are four or six.
  /// Integral of the node's shape function over flat faces: area_mm2 of linear faces; of a tri6 a
  /// third at mid-edge nodes, zero at corners. Springs with these areas transfer a uniform pressure
  /// without error.
  double load_area_mm2 = 0.0;
  Vec3 normal_L = Vec3::Zero();  ///< Out of the tissue; mean by area, unit length.
};

/// \param tissue  with the face set "boundary", counter-clockwise seen from outside.
/// \returns one entry for each node of the mesh.
[[nodiscard]] std::vector<BoundaryNode> boundary_nodes(const mesh::VolumeMesh& tissue);

}  // namespace lefort::predict
