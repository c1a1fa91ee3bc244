/// \file
/// The skin of a volume mesh: faces that belong to one element alone.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <vector>

namespace lefort::mesh {

/// The boundary triangles of a mesh of tetrahedra, counter-clockwise seen from outside, in the
/// order of the elements and of the faces within them.
///
/// \pre Every block is kTet4.
[[nodiscard]] std::vector<Face3> boundary_faces(const VolumeMesh& mesh);

/// The nodes of some faces, ascending, each once.
[[nodiscard]] std::vector<std::int32_t> nodes_of_faces(std::span<const Face3> faces);

}  // namespace lefort::mesh
