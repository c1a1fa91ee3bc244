/// \file
/// Removes disconnected parts and hinges of a mesh.
#pragma once

#include <lefort/mesh/volume_mesh.h>

namespace lefort::mesh {

/// Finds the largest part whose elements are connected through faces, also among the elements
/// around each edge and each node: there are no hinges. Hence every boundary edge has two faces.
///
/// Where elements are connected only through an edge or a node, the smaller group is removed. The
/// order of nodes and elements is kept, unused nodes are removed. Among parts of equal size, the
/// one with the first element is kept. Sets are removed, because node numbers change.
///
/// \param mesh  one block of kTet4.
/// \returns the part.
[[nodiscard]] VolumeMesh largest_face_connected_part(const VolumeMesh& mesh);

}  // namespace lefort::mesh
