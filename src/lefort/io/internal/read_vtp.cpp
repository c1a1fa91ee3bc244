#include <lefort/io/internal/surface_formats.h>
#include <lefort/io/internal/vtk_xml.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace lefort::io::internal {
namespace {

/// Arrays of a surface; the name of the points array varies.
const std::vector<WantedArray> kVtpArrays{{"Points", ""},        {"Polys", "connectivity"},
                                          {"Polys", "offsets"},  {"Strips", "connectivity"},
                                          {"Strips", "offsets"}, {"FieldData", "SPACE"}};

std::int32_t vertex_number(double in_piece, std::size_t first_of_piece) {
  const double number = in_piece + double(first_of_piece);
  const bool fits = in_piece >= 0.0 && number <= double(std::numeric_limits<std::int32_t>::max());
  return fits && number == std::floor(number) ? std::int32_t(number) : -1;
}

/// Adds the polygons, or strips, of a piece; false if an offset is out of range.
bool add_cells(const XmlArrays& file, int piece, const char* kind, std::size_t first_vertex,
               SurfaceFile& surface) {
  const auto* connectivity = find_array(file, piece, kind, "connectivity");
  const auto* offsets = find_array(file, piece, kind, "offsets");
  if (connectivity == nullptr || offsets == nullptr)
    return connectivity == nullptr && offsets == nullptr;
  std::size_t begin = 0;
  std::vector<std::int32_t> corners;
  for (const double offset : *offsets) {
    if (!(offset >= double(begin) && offset <= double(connectivity->size()))) return false;
    const auto end = std::size_t(offset);
    corners.clear();
    for (std::size_t n = begin; n < end; ++n)
      corners.push_back(vertex_number((*connectivity)[n], first_vertex));
    begin = end;
    if (std::string_view(kind) == "Polys") {
      add_polygon(corners, surface);
      continue;
    }
    for (std::size_t n = 2; n < corners.size();
         ++n)  // Every second triangle of a strip is reversed.
      surface.triangles.push_back({corners[n - 2 + n % 2], corners[n - 1 - n % 2], corners[n]});
  }
  return true;
}

}  // namespace

Result<SurfaceFile> parse_vtp(std::string_view bytes, const std::string& name) {
  LEFORT_TRY(const XmlArrays file, parse_vtk_xml(bytes, name, "PolyData", kVtpArrays));
  SurfaceFile surface;
  for (int piece = 1; piece <= file.pieces; ++piece) {
    const std::size_t first_vertex = surface.vertices.size();
    const auto* points = find_array(file, piece, "Points", "");
    if (points == nullptr || points->size() % 3 != 0)
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("{}: piece {} has no points of three coordinates", name, piece));
    for (std::size_t n = 0; n < points->size(); n += 3)
      surface.vertices.emplace_back((*points)[n], (*points)[n + 1], (*points)[n + 2]);
    if (!add_cells(file, piece, "Polys", first_vertex, surface) ||
        !add_cells(file, piece, "Strips", first_vertex, surface))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("{}: the cells of piece {} are inconsistent", name, piece));
  }
  if (const auto* space = find_array(file, 0, "FieldData", "SPACE"))
    surface.is_ras = space->size() >= 3 && (*space)[0] == 'R' && (*space)[1] == 'A';
  return surface;
}

}  // namespace lefort::io::internal
