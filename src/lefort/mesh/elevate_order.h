/// \file
/// Second-order elements on the edges of a linear mesh.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace lefort::mesh {

/// A mesh of tet10, wedge15 and hex20.
struct QuadraticMesh {
  VolumeMesh mesh;  ///< Corners keep their numbers; mid-edge nodes follow.
  /// Corners at the ends of the edge of each mid-edge node, ascending; in the order of the nodes.
  std::vector<std::array<std::int32_t, 2>> ends;

  /// \returns the number of corners: that of the first mid-edge node.
  [[nodiscard]] Index corner_count() const { return mesh.node_count() - Index(ends.size()); }
};

/// Puts a node in the middle of each edge: tet4, wedge6 and hex8 become tet10, wedge15 and hex20.
/// Edges stay straight. Elements keep their numbers and regions.
///
/// Each face set keeps its faces, with mid-edge nodes. A node set with the name of a face set gets
/// the nodes of that face set in addition; any other node set gets the mid-edge nodes between two
/// of its nodes.
///
/// \param linear  elements without pyramids.
/// \returns the mesh, with the same blocks and sets.
/// \pre each face of a set is a face of an element.
[[nodiscard]] QuadraticMesh elevate_order(VolumeMesh linear);

}  // namespace lefort::mesh
