/// \file
/// The boundary of a volume mesh: faces that belong to one element only.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <vector>

namespace lefort::mesh {

/// Two elements are joined by a face if it has the same corners in both. Where a quadrilateral
/// meets two triangles, the elements are not joined, and all three faces are boundary.
///
/// \param mesh  elements of any shape.
/// \returns the faces of one element only, counter-clockwise seen from outside, in the order of the
///   elements and of the faces within them.
[[nodiscard]] std::vector<Face> boundary_faces(const VolumeMesh& mesh);

/// Splits faces into triangles over their nodes.
///
/// \param faces  of any shape.
/// \returns in the order of the faces: one for a tri3, two for a quad4, four for a tri6, six for a
///   quad8.
[[nodiscard]] std::vector<Face3> triangles_of(std::span<const Face> faces);

/// \param faces  of any shape.
/// \returns the nodes of the faces, ascending, without duplicates.
[[nodiscard]] std::vector<std::int32_t> nodes_of_faces(std::span<const Face> faces);

}  // namespace lefort::mesh
