#include <lefort/io/vertex_array.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/served_case.h>
#include <lefort/server/case/surface_encoding.h>

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A scalar field on a surface that a page can request.
struct NamedValues {
  std::string_view name;
  /// Nothing if the segment name is not valid.
  std::optional<fs::path> (*file)(const CaseFolder&, std::string_view segment);
  const char* array;  ///< In the file.
};

/// \param segment  empty for the only one.
std::optional<fs::path> of_moved_segment(const CaseFolder& folder, std::string_view segment) {
  if (segment.empty()) return folder.prediction() / "bone_segment_moved.vtp";
  return segment_result(folder, fmt::format("bone_segment_moved_{}.vtp", segment));
}

const NamedValues kValues[] = {{"contact-pressure", of_moved_segment, "contact_pressure_kpa"},
                               {"contact-depth", of_moved_segment, "contact_depth_mm"},
                               {"difference",
                                [](const CaseFolder& c, std::string_view) {
                                  return std::optional(c.comparison() / "difference.vtp");
                                },
                                "difference_mm"}};

Response get_values(ServedCase& served, const Request& request, const PathValues& values) {
  for (const NamedValues& named : kValues) {
    if (named.name != values[0]) continue;
    const auto segment = request.query.find("segment");
    const auto file =
        named.file(served.folder, segment == request.query.end() ? "" : segment->second);
    if (!file) return not_found("no such segment");
    const auto etag = served.folder.etag(*file);
    if (!etag) return not_found("these values are not computed yet");
    if (is_not_modified(request, etag)) return not_modified(etag);
    const auto numbers = io::read_vertex_array(*file, named.array);
    if (!numbers) return not_found("these values do not exist: predict again");
    return with_etag(binary_response(shared_bytes(encode_floats(*numbers))), etag);
  }
  return not_found("no values of that name");
}

Response get_comparison(ServedCase& served, const Request& request, const PathValues&) {
  const fs::path file = served.folder.comparison() / "compare.json";
  const auto etag = served.folder.etag(file);
  if (!etag) return not_found("the case has no comparison");
  if (is_not_modified(request, etag)) return not_modified(etag);
  const json found = read_object(file);
  try {
    json regions = json::array(), movements = json::array(), registration;
    for (const json& row : found.at("regions"))
      regions.push_back({{"region", row.at("region")},
                         {"face", row.at("face")},
                         {"baseline_no_change", row.value("baseline_no_change", json())}});
    for (const json& one : found.value("movements", json::array()))
      movements.push_back({{"segment", one.at("segment")},
                           {"achieved", one.at("achieved")},
                           {"from_plan_to_achieved", one.at("from_plan_to_achieved")}});
    if (found.contains("registration"))
      registration = {{"rms_mm", found["registration"].at("rms_mm")},
                      {"inlier_fraction", found["registration"].at("inlier_fraction")}};
    return with_etag(json_response({{"regions", regions},
                                    {"missing", found.at("regions_missing")},
                                    {"movements", movements},
                                    {"registration", registration},
                                    {"warnings", found.value("warnings", json::array())}}),
                     etag);
  } catch (const json::exception&) {
    return error_response(422, "invalid", "compare.json is damaged: compare again");
  }
}

}  // namespace

std::span<const Route> comparison_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/comparison", get_comparison},
                                      {"GET", "/values/{values}", get_values}};
  return kRoutes;
}

}  // namespace lefort::server
