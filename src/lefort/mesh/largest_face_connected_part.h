/// \file
/// Removes disconnected parts and hinges of a mesh.
#pragma once

#include <lefort/mesh/volume_mesh.h>

namespace lefort::mesh {

/// Finds the part with most elements whose elements are connected through faces, also among the
/// elements around each edge and each node. Hence every boundary edge has two faces.
///
/// A hinge is an edge or a node whose elements form several groups without common faces. All groups
/// but the largest are removed. The order of nodes and elements is kept, unused nodes are removed.
/// Among parts or groups of equal size, the one with the first element is kept. Sets are removed,
/// because node numbers change.
///
/// \param mesh  one block of kTet4.
/// \returns the part.
[[nodiscard]] VolumeMesh largest_face_connected_part(const VolumeMesh& mesh);

}  // namespace lefort::mesh
