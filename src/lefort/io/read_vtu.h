/// \file
/// Volume meshes from VTK XML files.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>

namespace lefort::io {

/// Reads nodes, elements and, if there is one, the element array "region". Elements of one shape
/// make one block, shapes in the order of their first element; sets are not in the file.
///
/// \returns kFileNotFound; kFileCorrupt when it is no whole VTU, names a missing node or has a
///   coordinate that is not finite; kFileUnsupported for shapes the solver does not know.
[[nodiscard]] Result<mesh::VolumeMesh> read_vtu(const std::filesystem::path& file);

}  // namespace lefort::io
