/// \file
/// Elements in parts of the body that are more than one layer of elements thick.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::fem {

/// An element is flagged if it, or an element with which it shares a corner, has an interior
/// corner, which is a corner on no boundary face. A single layer has no interior corners.
///
/// \param mesh  \pre the nodes of its blocks exist.
/// \returns one flag per element, through the blocks; empty if no shape in the mesh needs the flags
///   (kHasPointwiseBulk).
[[nodiscard]] std::vector<char> elements_in_thick_parts(const mesh::VolumeMesh& mesh);

}  // namespace lefort::fem
