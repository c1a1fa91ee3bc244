#include <lefort/server/api/contract.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/served_case.h>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Keys of uncertainty.json that a page shows; the table of the samples can be long.
constexpr const char* kShownKeys[] = {
    "notice",     "version",     "seed",       "inputs",          "inputs_without_effect",
    "samples",    "models",      "regions",    "element_size_mm", "mean_band_mm",
    "correction", "convergence", "path_check", "interval_level"};

Response get_uncertainty(ServedCase& served, const Request& request, const PathValues&) {
  const fs::path file = served.folder.uncertainty() / "uncertainty.json";
  const auto etag = served.folder.etag(file);
  if (!etag) return not_found("the case has no band");
  if (is_not_modified(request, etag)) return not_modified(etag);
  const json document = read_object(file);
  json shown = json::object();
  for (const char* key : kShownKeys)
    if (const auto found = document.find(key); found != document.end()) shown[key] = *found;
  // Any program may have written the file.
  std::string text = shown.dump(-1, ' ', false, json::error_handler_t::replace);
  if (const auto valid = parse_by_contract(text, "Uncertainty"); !valid)
    return error_response(422, "invalid",
                          "uncertainty.json is damaged, or of another version: compute the band "
                          "again");
  Response reply;
  reply.text = std::move(text);
  return with_etag(std::move(reply), etag);
}

}  // namespace

std::span<const Route> uncertainty_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/uncertainty", get_uncertainty}};
  return kRoutes;
}

}  // namespace lefort::server
