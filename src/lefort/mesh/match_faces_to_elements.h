/// \file
/// Matches given faces with the faces of elements.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <vector>

namespace lefort::mesh {

/// Finds for each face the element face with the same corners. A boundary face becomes
/// counter-clockwise seen from outside, whatever its given orientation. A face between two elements
/// keeps its orientation.
///
/// \param mesh   elements of any shape.
/// \param faces  faces whose nodes exist in `mesh`.
/// \returns as many faces in the same order; or kMeshInvalid if one belongs to no element or occurs
///   twice, with its corners in the message.
[[nodiscard]] Result<std::vector<Face>> match_faces_to_elements(const VolumeMesh& mesh,
                                                                std::span<const Face> faces);

}  // namespace lefort::mesh
