/// \file
/// The bytes of surface files, parsed and made. `name` is what messages call the file.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/surface_files.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io::internal {

/// What a file says, unchecked but for its syntax: corners may point nowhere, and repeat.
struct SurfaceFile {
  std::vector<Vec3> vertices;
  std::vector<geometry::Triangle> triangles;
  bool is_ras = false;  ///< The file says its coordinates are RAS.
};

[[nodiscard]] Result<SurfaceFile> parse_stl(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<SurfaceFile> parse_ply(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<SurfaceFile> parse_obj(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<SurfaceFile> parse_vtp(std::string_view bytes, const std::string& name);

[[nodiscard]] std::string stl_bytes(const geometry::TriangleMesh& mesh);
[[nodiscard]] std::string ply_bytes(const geometry::TriangleMesh& mesh);
[[nodiscard]] std::string obj_bytes(const geometry::TriangleMesh& mesh);
/// \returns the bytes, or kFileUnwritable when VTK cannot make them (memory).
[[nodiscard]] Result<std::string> vtp_bytes(const geometry::TriangleMesh& mesh,
                                            const std::vector<VertexArray>& arrays);

/// Adds a polygon's triangles. A corner may point nowhere: then a fan is added, for the check of
/// all corners to find it.
void add_polygon(std::span<const std::int32_t> corners, SurfaceFile& surface);

/// Takes the next run of characters that are no white space off the front of `text`.
[[nodiscard]] std::string_view take_word(std::string_view& text);

/// Takes the next line, without its end, off the front of `text`.
[[nodiscard]] std::string_view take_line(std::string_view& text);

/// Whether `word` is one number as a whole; no locale has a say.
[[nodiscard]] bool parse_number(std::string_view word, double& number);

}  // namespace lefort::io::internal
