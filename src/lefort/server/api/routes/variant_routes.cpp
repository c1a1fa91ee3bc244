#include <lefort/server/api/contract.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/served_case.h>
#include <lefort/server/case/variants.h>

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

namespace lefort::server {
namespace {

using nlohmann::json;

/// Jobs read and replace the files of a variant.
std::optional<Response> refused_if_busy(ServedCase& served, const char* what) {
  if (served.jobs.is_idle()) return std::nullopt;
  return error_response(
      409, "busy", fmt::format("a job is running: a variant can be {} when it has ended", what));
}

Response get_variants(ServedCase& served, const Request&, const PathValues&) {
  return json_response(list_variants(served.folder));
}

Response post_variant(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "VariantRequest");
  if (!body.value) return body.error;
  const std::scoped_lock lock(served.writing);
  if (auto refused = refused_if_busy(served, "kept")) return *refused;
  if (const auto kept = keep_variant(served.folder, (*body.value)["name"]); !kept)
    return error_response(kept.error(), "name");
  served.report_stages();
  return json_response(list_variants(served.folder), 201);
}

Response post_variant_load(ServedCase& served, const Request& request, const PathValues& values) {
  const std::scoped_lock lock(served.writing);
  if (auto refused = refused_if_busy(served, "loaded")) return *refused;
  if (auto refused = check_precondition(request, served.folder.etag(served.folder.plan())))
    return *refused;
  if (const auto loaded = load_variant(served.folder, values[0]); !loaded)
    return error_response(loaded.error(), "variant");
  served.report_stages();
  return with_etag(empty_reply(), served.folder.etag(served.folder.plan()));
}

Response delete_variant_route(ServedCase& served, const Request&, const PathValues& values) {
  const std::scoped_lock lock(served.writing);
  if (auto refused = refused_if_busy(served, "deleted")) return *refused;
  if (const auto deleted = delete_variant(served.folder, values[0]); !deleted)
    return error_response(deleted.error(), "variant");
  served.report_stages();
  return empty_reply();
}

Response get_side_by_side(ServedCase& served, const Request& request, const PathValues&) {
  const auto file = served.folder.side_by_side() / "variants.json";
  const auto etag = served.folder.etag(file);
  if (!etag) return not_found("no variants were put side by side yet");
  if (is_not_modified(request, etag)) return not_modified(etag);
  json document = read_object(file);
  document.erase("lefort_variants");
  // Any program may have written the file.
  std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  if (const auto valid = parse_by_contract(text, "SideBySide"); !valid)
    return error_response(422, "invalid",
                          "variants.json is damaged, or of another version: compare them again");
  Response reply;
  reply.text = std::move(text);
  return with_etag(std::move(reply), etag);
}

}  // namespace

std::span<const Route> variant_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/variants", get_variants},
                                      {"POST", "/variants", post_variant},
                                      {"DELETE", "/variants/{variant}", delete_variant_route},
                                      {"POST", "/variants/{variant}/load", post_variant_load},
                                      {"GET", "/side-by-side", get_side_by_side}};
  return kRoutes;
}

}  // namespace lefort::server
