/// \file
/// Volume meshes from files, by their ending.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>
#include <string>

namespace lefort::io {

/// \param file     .vtu (read_vtu.h) or .msh (gmsh.h).
/// \param regions  as read_vtu() takes it; a .msh has its physical volumes.
/// \returns what these return; kFileUnsupported for another ending, or an array of regions asked of
///   a .msh.
[[nodiscard]] Result<mesh::VolumeMesh> read_volume_mesh(const std::filesystem::path& file,
                                                        const std::string& regions = {});

}  // namespace lefort::io
