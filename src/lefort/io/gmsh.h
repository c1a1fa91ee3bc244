/// \file
/// Volume meshes from Gmsh files, format 4.1, text or binary.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>

namespace lefort::io {

/// Reads the elements of dimension 3 and these physical groups:
///
///     Physical Volume   region: its tag; its name in VolumeMesh::region_names
///     Physical Surface  face set and node set of its name
///     Physical Curve    node set
///     Physical Point    node set
///
/// A group without a name is named "surface 7", "curve 7" or "point 7" after its tag; volumes in no
/// group are region 0. Nodes without an element (such as the center of an arc) are omitted.
/// Coordinates are not converted: they count as mm in frame L.
///
/// \param file  the Gmsh file.
/// \returns the mesh, or
///   - kFileNotFound     the file does not exist;
///   - kFileCorrupt      it is truncated, damaged or inconsistent: a count exceeds the file, a
///                       coordinate is not finite, a node is duplicated or missing;
///   - kFileUnsupported  its version is not 4.1, it is big-endian or partitioned, or has elements
///                       that the solver does not support; the message states how to save it;
///   - kMeshInvalid      it has no volume, a volume is in two groups, two sets have the same name,
///                       a group contains nodes or faces of no volume, or all groups are empty.
[[nodiscard]] Result<mesh::VolumeMesh> read_gmsh(const std::filesystem::path& file);

}  // namespace lefort::io
