#include <lefort/core/check.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/internal/run_in_child.h>
#include <lefort/io/internal/surface_formats.h>
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

// Sixteen million triangles as text; larger surfaces cannot be processed.
constexpr std::uintmax_t kMaxSurfaceBytes = std::uintmax_t(4) << 30;

std::string ending_of(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return ending;
}

Error unsupported(const fs::path& path) {
  return {ErrorCode::kFileUnsupported,
          fmt::format("{} must end in .vtp, .stl, .ply or .obj", path.string())};
}

const std::string kSurfaceContents = "the contents of the file";

Result<internal::SurfaceFile> parse(std::string_view ending, const std::string& name,
                                    std::string_view bytes) {
  if (ending == ".vtp") return internal::parse_vtp(bytes, name);
  if (ending == ".stl") return internal::parse_stl(bytes, name);
  if (ending == ".ply") return internal::parse_ply(bytes, name);
  return internal::parse_obj(bytes, name);
}

/// The task of a child. \param request  four characters of the ending, and the name in messages.
Result<void> surface_in_child(int input, std::string_view request, ResultWriter& result) {
  constexpr std::size_t kEnding = 4;
  if (request.size() < kEnding) return tl::unexpected(damaged_result(kSurfaceContents));
  LEFORT_TRY(const std::string bytes, read_all(input, kSurfaceContents));
  LEFORT_TRY(const internal::SurfaceFile surface,
             parse(request.substr(0, kEnding), std::string(request.substr(kEnding)), bytes));
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  static_assert(sizeof(geometry::Triangle) == 3 * sizeof(std::int32_t));
  result.number(std::int32_t{surface.is_ras});
  result.number(static_cast<std::uint64_t>(surface.vertices.size()));
  result.bytes(surface.vertices.data(), surface.vertices.size() * sizeof(Vec3));
  result.number(static_cast<std::uint64_t>(surface.triangles.size()));
  result.bytes(surface.triangles.data(), surface.triangles.size() * sizeof(geometry::Triangle));
  return {};
}

/// Reads the result of surface_in_child(); false if it is damaged.
bool take_surface(ResultReader& result, internal::SurfaceFile& surface) {
  std::int32_t is_ras = 0;
  std::size_t count = 0;
  if (!result.number(is_ras) || !result.count(count, sizeof(Vec3))) return false;
  surface.is_ras = is_ras != 0;
  surface.vertices.resize(count);
  if (!result.bytes(surface.vertices.data(), count * sizeof(Vec3)) ||
      !result.count(count, sizeof(geometry::Triangle)))
    return false;
  surface.triangles.resize(count);
  return result.bytes(surface.triangles.data(), count * sizeof(geometry::Triangle)) &&
         result.at_end();
}

Result<internal::SurfaceFile> read_in_child(const fs::path& path, Progress& progress) {
  constexpr std::uint64_t kMemoryPerByte = 200;  // As of VTK's files.
  LEFORT_TRY(const OpenedFile input, open_input(path, kMaxSurfaceBytes));
  LEFORT_TRY(
      ReaderValues values,
      run_in_child(input.descriptor,
                   {surface_in_child, kSurfaceContents, ending_of(path) + path.filename().string(),
                    limits_of(input.bytes, kMemoryPerByte * input.bytes)},
                   progress));
  internal::SurfaceFile surface;
  if (!take_surface(*values, surface)) return tl::unexpected(damaged_result(kSurfaceContents));
  return surface;
}

Result<void> check(const internal::SurfaceFile& surface, const std::string& name) {
  const auto count = Index(surface.vertices.size());
  for (Index v = 0; v < count; ++v)
    if (!surface.vertices[std::size_t(v)].allFinite())
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("{}: vertex {} has a coordinate that is not finite", name, v));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (const std::int32_t corner : surface.triangles[t])
      if (corner < 0 || corner >= count)
        return fail(ErrorCode::kFileCorrupt,
                    fmt::format("{}: triangle {} has a corner that is not one of the {} vertices",
                                name, t, count));
  return {};
}

/// Removes triangles with a repeated corner, and vertices without a triangle.
geometry::TriangleMesh cleaned(internal::SurfaceFile surface) {
  const geometry::TriangleMesh mesh{std::move(surface.vertices), std::move(surface.triangles)};
  return geometry::keep_triangles(mesh, [&](Index t) {
    const auto& [a, b, c] = mesh.triangles[std::size_t(t)];
    return a != b && b != c && c != a;
  });
}

Result<void> check_writable(const fs::path& path, const geometry::TriangleMesh& mesh,
                            const std::vector<VertexArray>& arrays) {
  for (const geometry::Triangle& triangle : mesh.triangles)
    for (const std::int32_t corner : triangle)
      LEFORT_CHECK(corner >= 0 && corner < mesh.vertex_count());
  for (const VertexArray& array : arrays) {
    const auto length = std::visit([](const auto& v) { return Index(v.size()); }, array.values);
    if (length != mesh.vertex_count())
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("array {} has {} values, the surface {} vertices", array.name, length,
                              mesh.vertex_count()));
  }
  if (!arrays.empty() && ending_of(path) != ".vtp")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} cannot contain array {}, use .vtp", path.filename().string(),
                            arrays.front().name));
  return {};
}

}  // namespace

Result<geometry::TriangleMesh> read_surface(const fs::path& path, Progress& progress) {
  const std::string ending = ending_of(path);
  if (ending != ".vtp" && ending != ".stl" && ending != ".ply" && ending != ".obj")
    return tl::unexpected(unsupported(path));
  const std::string name = path.filename().string();
  LEFORT_TRY(internal::SurfaceFile surface, read_in_child(path, progress));
  LEFORT_TRY_VOID(check(surface, name));
  if (surface.is_ras)
    for (Vec3& p : surface.vertices) p.head<2>() *= -1.0;  // A rotation: preserves orientation.
  geometry::TriangleMesh mesh = cleaned(std::move(surface));
  if (mesh.triangles.empty())
    return fail(ErrorCode::kMeshInvalid, fmt::format("{} has no triangle", name));
  return mesh;
}

Result<void> write_surface(const fs::path& path, const geometry::TriangleMesh& mesh_L,
                           const std::vector<VertexArray>& arrays) {
  LEFORT_TRY_VOID(check_writable(path, mesh_L, arrays));
  const std::string ending = ending_of(path);
  if (ending == ".vtp") {
    LEFORT_TRY(const std::string bytes, internal::vtp_bytes(mesh_L, arrays));
    return write_text(path, bytes);
  }
  if (ending == ".stl") return write_text(path, internal::stl_bytes(mesh_L));
  if (ending == ".ply") return write_text(path, internal::ply_bytes(mesh_L));
  if (ending == ".obj") return write_text(path, internal::obj_bytes(mesh_L));
  return tl::unexpected(unsupported(path));
}

}  // namespace lefort::io
