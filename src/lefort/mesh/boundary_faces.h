/// \file
/// The skin of a volume mesh: faces that belong to one element alone.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <vector>

namespace lefort::mesh {

/// The faces of one element alone, counter-clockwise seen from outside, in the order of the
/// elements and of the faces within them.
///
/// Two elements share a face if it has the same corners. Where a quadrilateral lies beside two
/// triangles, the elements are not joined, and all three count as boundary.
[[nodiscard]] std::vector<Face> boundary_faces(const VolumeMesh& mesh);

/// The same surface in triangles over the nodes: a tri3 is its own, a quad4 makes two, a tri6 four
/// and a quad8 six, in the order of the faces.
[[nodiscard]] std::vector<Face3> triangles_of(std::span<const Face> faces);

/// The nodes of some faces, ascending, each once.
[[nodiscard]] std::vector<std::int32_t> nodes_of_faces(std::span<const Face> faces);

}  // namespace lefort::mesh
