/// \file
/// Volume meshes from Gmsh files, format 4.1, text or binary.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>

namespace lefort::io {

/// Reads the elements of dimension 3 and the physical groups:
///
///     Physical Volume   region: its tag; its name in VolumeMesh::region_names
///     Physical Surface  face set and node set of its name
///     Physical Curve    node set
///     Physical Point    node set
///
/// A group without a name is called "surface 7", "curve 7" or "point 7" after its tag; volumes in
/// no group are region 0. Nodes that no element uses (the center of an arc) are left out.
/// Coordinates are taken as mm in L.
///
/// \returns the mesh, or
///   - kFileNotFound     there is no such file;
///   - kFileCorrupt      it is cut short, damaged or contradicts itself: a count beyond the file, a
///     coordinate that is not finite, a node twice or missing;
///   - kFileUnsupported  it is of another version than 4.1, partitioned, or has elements the solver
///     does not know; the sentence says how to save it otherwise;
///   - kMeshInvalid      there are no volumes, one is in two groups, two sets have the same name,
///     or a group holds nodes or faces of no volume.
[[nodiscard]] Result<mesh::VolumeMesh> read_gmsh(const std::filesystem::path& file);

}  // namespace lefort::io
