/// \file
/// Parsers and writers of surface files in memory. `name` is the name of the file in messages.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/surface_files.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io::internal {

/// Contents of a file of valid syntax: corners may be out of range or repeated.
struct SurfaceFile {
  std::vector<Vec3> vertices;
  std::vector<geometry::Triangle> triangles;
  bool is_ras = false;  ///< The file states that its coordinates are RAS.
};

[[nodiscard]] Result<SurfaceFile> parse_stl(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<SurfaceFile> parse_ply(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<SurfaceFile> parse_obj(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<SurfaceFile> parse_vtp(std::string_view bytes, const std::string& name);

[[nodiscard]] std::string stl_bytes(const geometry::TriangleMesh& mesh);
[[nodiscard]] std::string ply_bytes(const geometry::TriangleMesh& mesh);
[[nodiscard]] std::string obj_bytes(const geometry::TriangleMesh& mesh);
/// \returns the bytes, or kFileUnwritable if VTK fails (memory).
[[nodiscard]] Result<std::string> vtp_bytes(const geometry::TriangleMesh& mesh,
                                            const std::vector<VertexArray>& arrays);

/// Adds the triangles of a polygon. If a corner is out of range, a triangle fan is added, and the
/// later check of all corners reports it.
void add_polygon(std::span<const std::int32_t> corners, SurfaceFile& surface);

/// Removes the next word (without white space) from the front of `text` and returns it.
[[nodiscard]] std::string_view take_word(std::string_view& text);

/// Removes the next line from the front of `text` and returns it without its line break.
[[nodiscard]] std::string_view take_line(std::string_view& text);

/// Parses a number; the whole word must be one, in the C locale.
[[nodiscard]] bool parse_number(std::string_view word, double& number);

}  // namespace lefort::io::internal
