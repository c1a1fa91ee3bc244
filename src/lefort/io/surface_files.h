/// \file
/// Triangle surfaces in files: VTP, STL, PLY, OBJ; mm, LPS.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace lefort::io {

/// A quantity at every vertex, for example "displacement_mm".
struct VertexArray {
  std::string name;
  std::variant<std::vector<double>, std::vector<Vec3>> values;
};

/// Reads a surface; the ending says the format: .vtp, .stl (text or binary), .ply, .obj.
///
/// Polygons are triangulated, the corners an STL repeats are merged, triangles with a repeated
/// corner and vertices no triangle uses are dropped. The surface may be open; who needs a closed
/// one checks. A `SPACE=RAS` comment as 3D Slicer writes turns the coordinates to LPS; all else is
/// taken for LPS.
///
/// \returns the mesh, or
///   - kFileNotFound     there is no such file;
///   - kFileUnsupported  the ending is none of the four;
///   - kFileCorrupt      the file is not of its format, is cut short, or has a coordinate that is
///     not finite;
///   - kMeshInvalid      no triangle is in it.
[[nodiscard]] Result<geometry::TriangleMesh> read_surface(const std::filesystem::path& path);

/// Writes a surface; formats as for read_surface, STL and PLY in binary.
///
/// \param arrays  one value per vertex each; VTP alone can hold them.
/// \returns nothing, or
///   - kInvalidArgument  an array's length is not the number of vertices, or the format holds none;
///   - kFileUnsupported  the ending is none of the four;
///   - kFileUnwritable   see write_atomically.
/// \note The same mesh gives the same bytes: no time, user or program version is stored.
[[nodiscard]] Result<void> write_surface(const std::filesystem::path& path,
                                         const geometry::TriangleMesh& mesh_L,
                                         const std::vector<VertexArray>& arrays = {});

}  // namespace lefort::io
