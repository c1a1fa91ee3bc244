#include <lefort/io/internal/surface_formats.h>

#include <fmt/format.h>

#include <charconv>
#include <limits>

namespace lefort::io::internal {
namespace {

/// Returns the vertex index before the first slash; numbers count from 1, or backward from the last
/// vertex if negative. Out of range: -1.
std::int32_t vertex_number(std::string_view word, Index vertex_count) {
  word = word.substr(0, word.find('/'));
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc{} || end != word.data() + word.size() || number == 0) return -1;
  const std::int64_t from_0 = number > 0 ? number - 1 : vertex_count + number;
  return from_0 < 0 || from_0 > std::numeric_limits<std::int32_t>::max() ? -1
                                                                         : std::int32_t(from_0);
}

/// Reads a line and its continuation lines (backslash at the end).
std::string take_whole_line(std::string_view& text) {
  std::string line(take_line(text));
  while (line.ends_with('\\') && !text.empty()) {
    line.back() = ' ';
    line += take_line(text);
  }
  return line;
}

}  // namespace

Result<SurfaceFile> parse_obj(std::string_view bytes, const std::string& name) {
  SurfaceFile surface;
  std::vector<std::vector<std::int32_t>> faces;
  std::string_view text = bytes;
  for (Index number = 1; !text.empty(); ++number) {
    const std::string whole = take_whole_line(text);
    std::string_view line = whole;
    if (line.starts_with('#') && line.find("SPACE=RAS") != std::string_view::npos)
      surface.is_ras = true;
    const std::string_view word = take_word(line);
    if (word == "v") {
      Vec3 p;
      for (Index axis = 0; axis < 3; ++axis)
        if (!parse_number(take_word(line), p[axis]))
          return fail(ErrorCode::kFileCorrupt,
                      fmt::format("{}: line {} has no vertex of three numbers", name, number));
      surface.vertices.push_back(p);
    } else if (word == "f") {
      std::vector<std::int32_t> face;
      for (std::string_view corner = take_word(line); !corner.empty() && corner[0] != '#';
           corner = take_word(line))
        face.push_back(vertex_number(corner, Index(surface.vertices.size())));
      if (face.size() < 3)
        return fail(ErrorCode::kFileCorrupt,
                    fmt::format("{}: line {} has a face of {} corners, expected 3 or more", name,
                                number, face.size()));
      faces.push_back(std::move(face));
    }
  }
  if (surface.vertices.empty())
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} is not an OBJ file: it has no vertex", name));
  for (const std::vector<std::int32_t>& face : faces) add_polygon(face, surface);
  return surface;
}

std::string obj_bytes(const geometry::TriangleMesh& mesh) {
  std::string text = "# lefort; unit mm\n# SPACE=LPS\n";
  for (const Vec3& p : mesh.vertices)
    text += fmt::format("v {} {} {}\n", float(p[0]), float(p[1]), float(p[2]));
  for (const geometry::Triangle& t : mesh.triangles)
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

}  // namespace lefort::io::internal
