/// \file
/// What is left of a mesh without its stray pieces and loose corners.
#pragma once

#include <lefort/mesh/volume_mesh.h>

namespace lefort::mesh {

/// The largest part whose elements hang together through faces, also around each edge and each
/// node: no hinges. So every edge of its boundary has two faces.
///
/// Where elements meet in a hinge alone, the fewer of them go. Order of nodes and elements is kept,
/// nodes out of use are dropped; of equally large parts the one with the first element wins. Sets
/// are dropped: they would name other nodes.
///
/// \pre One block of kTet4.
[[nodiscard]] VolumeMesh largest_face_connected_part(const VolumeMesh& mesh);

}  // namespace lefort::mesh
