#include <lefort/io/surface_files.h>
#include <lefort/io/vertex_array.h>
#include <lefort/pipeline/prepare/interface_surface.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/served_case.h>
#include <lefort/server/case/surface_encoding.h>
#include <lefort/server/case/variants.h>

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Names of point data.
using ScalarNames = std::vector<std::string>;

Response surface_reply(ServedCase& served, const Request& request, const fs::path& file,
                       const ScalarNames& names = {}) {
  const auto etag = served.folder.etag(file);
  if (!etag) return not_found("this surface does not exist yet");
  if (is_not_modified(request, etag)) return not_modified(etag);
  const auto bytes = served.cached_surfaces.get(file.string(), *etag, [&]() -> Result<std::string> {
    LEFORT_TRY(const geometry::TriangleMesh mesh, io::read_surface(file));
    std::vector<std::vector<double>> scalars;
    for (const std::string& name : names) {
      LEFORT_TRY(std::vector<double> values, io::read_vertex_array(file, name));
      if (values.size() != mesh.vertices.size())
        return fail(ErrorCode::kFileCorrupt,
                    fmt::format("array {} has {} values, the surface {} vertices", name,
                                values.size(), mesh.vertices.size()));
      scalars.push_back(std::move(values));
    }
    return encode_surface(mesh, scalars);
  });
  if (!bytes) return error_response(bytes.error());
  Response reply = binary_response({*bytes, **bytes});
  reply.headers.emplace_back("X-Lefort-Scalars", fmt::format("{}", fmt::join(names, ",")));
  return with_etag(std::move(reply), etag);
}

Response get_surfaces(ServedCase& served, const Request&, const PathValues&) {
  json list = json::array();
  for (const NamedFile& surface : surface_catalog())
    if (const auto etag = served.folder.etag(surface.path(served.folder)))
      list.push_back({{"name", surface.name}, {"etag", *etag}});
  const json cut = read_object(served.folder.cut() / "cut.json");
  if (cut.contains("bones") && cut["bones"].is_array())
    for (const json& bone : cut["bones"]) {
      if (!bone.is_object()) continue;
      const std::string name = bone.value("name", "");
      if (!is_segment_name(name)) continue;
      if (const auto etag =
              served.folder.etag(served.folder.cut() / fmt::format("segment_{}.vtp", name)))
        list.push_back({{"name", "segments/" + name}, {"etag", *etag}});
    }
  const json guides = read_object(served.folder.guides() / "guides.json");
  if (guides.contains("guides") && guides["guides"].is_array())
    for (const json& guide : guides["guides"]) {
      if (!guide.is_object() || !guide.contains("name") || !guide["name"].is_string()) continue;
      const std::string name = guide["name"];
      const auto file = guide_result(served.folder, fmt::format("guide_{}.stl", name));
      if (const auto etag = file ? served.folder.etag(*file) : std::nullopt)
        list.push_back({{"name", "guides/" + name}, {"etag", *etag}});
    }
  const json variants = list_variants(served.folder)["variants"];
  for (const json& variant : variants) {
    const std::string name = variant["name"];
    if (const auto etag = served.folder.etag(face_of_variant(served.folder, name)))
      list.push_back({{"name", "variants/" + name}, {"etag", *etag}});
  }
  return json_response({{"surfaces", list}});
}

Response get_surface(ServedCase& served, const Request& request, const PathValues& values) {
  const NamedFile* const surface = find_named(surface_catalog(), values[0]);
  if (surface == nullptr) return not_found("no surface of that name");
  ScalarNames scalars;
  if (surface->name == kInterfaceSurface)
    scalars = {pipeline::kConditionArray, pipeline::kRuleArray};
  if (surface->name == kBandSurface) scalars = {"band_width_mm", "p5_mm", "p95_mm"};
  if (surface->name == kOcclusionSurface) scalars = {"gap_mm"};
  return surface_reply(served, request, surface->path(served.folder), scalars);
}

Response get_segment_surface(ServedCase& served, const Request& request, const PathValues& values) {
  if (!is_segment_name(values[0])) return not_found("no such segment");
  return surface_reply(served, request,
                       served.folder.cut() / fmt::format("segment_{}.vtp", values[0]));
}

Response get_guide_surface(ServedCase& served, const Request& request, const PathValues& values) {
  const auto file = guide_result(served.folder, fmt::format("guide_{}.stl", values[0]));
  if (!file) return not_found("no such guide");
  return surface_reply(served, request, *file);
}

Response get_variant_surface(ServedCase& served, const Request& request, const PathValues& values) {
  if (!is_variant_name(values[0])) return not_found("no variant of that name");
  return surface_reply(served, request, face_of_variant(served.folder, values[0]));
}

}  // namespace

std::span<const Route> surface_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/surfaces", get_surfaces},
                                      {"GET", "/surfaces/{surface}", get_surface},
                                      {"GET", "/surfaces/segments/{segment}", get_segment_surface},
                                      {"GET", "/surfaces/guides/{guide}", get_guide_surface},
                                      {"GET", "/surfaces/variants/{variant}", get_variant_surface}};
  return kRoutes;
}

}  // namespace lefort::server
