#include <lefort/io/internal/surface_formats.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>

namespace lefort::io::internal {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is read without conversion");

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kTriangleBytes = 50;  // Normal, three corners as float, two unused bytes.

/// STL repeats a corner for every triangle: equal coordinates become one vertex. NaN has no order
/// and would equal any vertex, so vertices that are not finite are not merged; the later check of
/// all vertices reports them.
class Corners {
 public:
  explicit Corners(SurfaceFile& surface) : surface_(surface) {}
  std::int32_t number(const Vec3& p) {
    const auto next = std::int32_t(surface_.vertices.size());
    if (!p.allFinite()) {
      surface_.vertices.push_back(p);
      return next;
    }
    const auto [place, is_new] = numbers_.try_emplace({p[0], p[1], p[2]}, next);
    if (is_new) surface_.vertices.push_back(p);
    return place->second;
  }

 private:
  SurfaceFile& surface_;
  std::map<std::array<double, 3>, std::int32_t> numbers_;
};

SurfaceFile parse_binary(std::string_view bytes, std::uint32_t count) {
  SurfaceFile surface;
  surface.triangles.reserve(count);
  Corners corners(surface);
  for (std::uint32_t t = 0; t < count; ++t) {
    std::array<float, 9> p{};
    std::memcpy(p.data(), bytes.data() + kHeaderBytes + 4 + t * kTriangleBytes + 12, sizeof p);
    geometry::Triangle triangle{};
    for (std::size_t c = 0; c < 3; ++c)
      triangle[c] = corners.number({double(p[3 * c]), double(p[3 * c + 1]), double(p[3 * c + 2])});
    surface.triangles.push_back(triangle);
  }
  return surface;
}

Result<SurfaceFile> parse_text(std::string_view text, const std::string& name) {
  SurfaceFile surface;
  Corners corners(surface);
  geometry::Triangle triangle{};
  std::size_t corner = 0;
  bool ended = false;
  for (Index number = 1; !text.empty(); ++number) {
    std::string_view line = take_line(text);
    const std::string_view word = take_word(line);
    if (word == "endsolid") ended = true;
    if (word != "vertex") continue;
    Vec3 p;
    for (Index axis = 0; axis < 3; ++axis)
      if (!parse_number(take_word(line), p[axis]))
        return fail(ErrorCode::kFileCorrupt,
                    fmt::format("{}: line {} has no vertex of three numbers", name, number));
    triangle[corner++] = corners.number(p);
    if (corner == 3) {
      surface.triangles.push_back(triangle);
      corner = 0;
    }
  }
  if (!ended || corner != 0)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} is truncated: \"endsolid\" is missing", name));
  return surface;
}

}  // namespace

Result<SurfaceFile> parse_stl(std::string_view bytes, const std::string& name) {
  // Binary files may also begin with "solid"; their length distinguishes them.
  std::uint32_t count = 0;
  if (bytes.size() >= kHeaderBytes + 4)
    std::memcpy(&count, bytes.data() + kHeaderBytes, sizeof count);
  const std::size_t wanted = kHeaderBytes + 4 + std::size_t(count) * kTriangleBytes;
  const bool is_text = bytes.starts_with("solid") && bytes.size() != wanted;

  if (!is_text && (bytes.size() < kHeaderBytes + 4 || bytes.size() < wanted))
    return fail(
        ErrorCode::kFileCorrupt,
        fmt::format("{} is not an STL file or is truncated: it has {} bytes, {} triangles need {}",
                    name, bytes.size(), count, wanted));
  const std::string_view header = bytes.substr(0, is_text ? bytes.find('\n') : kHeaderBytes);
  Result<SurfaceFile> surface = is_text ? parse_text(bytes, name) : parse_binary(bytes, count);
  if (surface) surface->is_ras = header.find("SPACE=RAS") != std::string_view::npos;
  return surface;
}

std::string stl_bytes(const geometry::TriangleMesh& mesh) {
  std::string bytes = "lefort; unit mm; SPACE=LPS";
  bytes.resize(kHeaderBytes, ' ');
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(std::uint32_t(mesh.triangle_count()));
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 normal = (mesh.corner(t, 1) - mesh.corner(t, 0))
                            .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                            .normalized();
    for (const Vec3& p : {normal, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)})
      for (Index axis = 0; axis < 3; ++axis) append(float(p[axis]));
    append(std::uint16_t(0));
  }
  return bytes;
}

}  // namespace lefort::io::internal
