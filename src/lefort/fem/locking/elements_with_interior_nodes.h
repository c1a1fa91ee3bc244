/// \file
/// Which elements lie where a body is more than a layer thick.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::fem {

/// For each element, through the blocks: whether a corner of its own, or of an element that it
/// shares a corner with, is inside, on no face that belongs to one element alone. In a single layer
/// there is no such corner; nor is there in a plane model, one element thick.
///
/// \returns one flag per element; none at all if no shape in the mesh asks (kHasBulkAtPoints).
/// \pre the blocks name nodes of the mesh.
[[nodiscard]] std::vector<char> elements_with_interior_nodes(const mesh::VolumeMesh& mesh);

}  // namespace lefort::fem
