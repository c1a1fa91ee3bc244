/// \file
/// Faces read from elsewhere become faces of the elements they lie on.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <vector>

namespace lefort::mesh {

/// Finds for each face the element that has the same corners, and takes that element's own face:
/// counter-clockwise seen from outside, whichever way round it was given. Of a face between two
/// elements the side is kept as given.
///
/// \param faces  \pre their nodes exist.
/// \returns as many faces in the same order, or kMeshInvalid if one lies on no element or is there
///   twice; the sentence names its corners.
[[nodiscard]] Result<std::vector<Face>> match_faces_to_elements(const VolumeMesh& mesh,
                                                                std::span<const Face> faces);

}  // namespace lefort::mesh
