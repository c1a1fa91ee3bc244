/// \file
/// Reads volume meshes in the format of the ending.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <filesystem>
#include <string>

namespace lefort::io {

/// Reads a volume mesh.
///
/// \param file     .vtu (read_vtu.h) or .msh (gmsh.h).
/// \param regions  as in read_vtu(); empty for .msh, whose regions are its physical volumes.
/// \returns as read_vtu() or read_gmsh(); kFileUnsupported for another ending, or for `regions`
///   with a .msh.
[[nodiscard]] Result<mesh::VolumeMesh> read_volume_mesh(const std::filesystem::path& file,
                                                        const std::string& regions = {});

}  // namespace lefort::io
