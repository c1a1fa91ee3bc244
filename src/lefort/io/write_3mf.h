/// \file
/// Writes a surface for a printer, with its unit and name.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

#include <filesystem>
#include <string>

namespace lefort::io {

/// Writes a 3MF file (3D Manufacturing Format, core specification 1.3): a zip archive with one
/// model of one object in mm. Written atomically.
///
/// \param path    of the file.
/// \param mesh_L  a closed surface.
/// \param title   of the model.
/// \returns nothing; or kMeshInvalid if the surface is empty; see write_atomically().
/// \note Equal meshes give equal bytes: no time is stored.
[[nodiscard]] Result<void> write_3mf(const std::filesystem::path& path,
                                     const geometry::TriangleMesh& mesh_L,
                                     const std::string& title);

}  // namespace lefort::io
