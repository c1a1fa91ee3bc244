/// \file
/// Triangle surfaces in VTP, STL, PLY and OBJ files, in mm and LPS.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
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

/// Reads a surface in the format of the ending: .vtp, .stl (text or binary), .ply, .obj.
///
/// Polygons are triangulated, equal points of an STL are merged, triangles with two equal corners
/// and vertices without a triangle are removed. The surface may be open; a caller that needs
/// a closed one must check. Coordinates are in LPS unless the file contains the comment `SPACE=RAS`
/// of 3D Slicer; then they are converted.
///
/// \param path      of the surface.
/// \param progress  requests to stop.
/// \returns the mesh, or
///   - kFileNotFound     the file does not exist;
///   - kFileUnsupported  another ending, or a VTP of another byte order or compressor;
///   - kFileCorrupt      not of its format, truncated, or a coordinate is not finite;
///   - kMeshInvalid      no triangle;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<geometry::TriangleMesh> read_surface(const std::filesystem::path& path,
                                                          Progress& progress = Progress::none());

/// Writes a surface atomically in the formats of read_surface(), STL and PLY in binary.
///
/// \param path    of the surface.
/// \param mesh_L  vertices in frame L [mm].
/// \param arrays  with one value per vertex; for VTP only.
/// \returns nothing, or
///   - kInvalidArgument  the length of an array is not the number of vertices, or there are arrays
///                       and the file is not a VTP;
///   - kFileUnsupported  another ending;
///   - kFileUnwritable   see write_atomically().
/// \note Equal meshes give equal bytes: no time, user or program version is stored.
[[nodiscard]] Result<void> write_surface(const std::filesystem::path& path,
                                         const geometry::TriangleMesh& mesh_L,
                                         const std::vector<VertexArray>& arrays = {});

}  // namespace lefort::io
