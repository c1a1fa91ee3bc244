/// \file
/// Volume meshes from files, by their ending.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>

namespace lefort::io {

/// \param file  .vtu (read_vtu.h) or .msh (gmsh.h).
/// \returns what these return, or kFileUnsupported for another ending.
[[nodiscard]] Result<mesh::VolumeMesh> read_volume_mesh(const std::filesystem::path& file);

}  // namespace lefort::io
