#include <lefort/core/check.h>
#include <lefort/server/api/api.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/served_case.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;

/// The parts of a path, between slashes.
std::vector<std::string_view> parts_of(std::string_view path) {
  std::vector<std::string_view> parts;
  while (!path.empty()) {
    path.remove_prefix(1);  // The slash.
    const std::size_t end = std::min(path.find('/'), path.size());
    parts.push_back(path.substr(0, end));
    path.remove_prefix(end);
  }
  return parts;
}

/// Values of the parameters if the path fits the pattern.
std::optional<PathValues> match(std::string_view pattern, std::string_view path) {
  const auto wanted = parts_of(pattern), given = parts_of(path);
  if (wanted.size() != given.size()) return std::nullopt;
  PathValues values;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (wanted[k].starts_with('{'))
      values.emplace_back(given[k]);
    else if (wanted[k] != given[k])
      return std::nullopt;
  }
  return values;
}

/// Removes the case folder from an error: the names of folders may be those of patients.
Response without_folder(Response reply, const fs::path& folder) {
  if (reply.status < 400) return reply;
  const std::string quoted = nlohmann::json(folder.string() + "/")
                                 .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const std::string root = quoted.substr(1, quoted.size() - 2);  // As in the text of the reply.
  for (std::size_t at = reply.text.find(root); at != std::string::npos;
       at = reply.text.find(root, at))
    reply.text.erase(at, root.size());
  return reply;
}

/// All groups of routes, in the order in which a case is worked on.
constexpr std::span<const Route> (*kGroups[])() = {
    case_routes,        job_routes,     scan_routes,     boundary_routes,   surface_routes,
    landmark_routes,    plan_routes,    movement_routes, prediction_routes, comparison_routes,
    uncertainty_routes, measure_routes, variant_routes,  file_routes};

}  // namespace

std::vector<Api::RouteName> Api::routes() {
  std::vector<RouteName> names;
  for (const auto group : kGroups)
    for (const Route& route : group()) names.push_back({route.method, route.path});
  return names;
}

Api::Api(CaseFolder folder, std::optional<fs::path> example, UploadLimits upload_limits)
    : served_(std::make_unique<ServedCase>(std::move(folder), std::move(example), upload_limits)) {}

Api::~Api() { stop(); }

const fs::path& Api::folder() const { return served_->folder.root(); }

EventLog& Api::events() { return served_->events; }

void Api::stop() {
  served_->events.stop();
  served_->jobs.stop();
}

Result<void> Api::begin_with_example() {
  if (there_is(served_->folder.ct())) return {};
  if (!served_->example)
    return fail(
        ErrorCode::kFileNotFound,
        "the scan of the example is not installed: install Debian's invesalius-examples, or "
        "set --example");
  LEFORT_TRY_VOID(served_->jobs.submit("import", {{"example", true}}));
  LEFORT_TRY_VOID(served_->jobs.submit("segment", nlohmann::json::object()));
  return {};
}

Response Api::handle(const Request& request) {
  LEFORT_CHECK(request.path.starts_with(kApiPrefix));
  const std::string_view path = std::string_view(request.path).substr(kApiPrefix.size());
  bool is_other_method = false;
  for (const auto group : kGroups)
    for (const Route& route : group()) {
      const auto values = match(route.path, path);
      if (!values) continue;
      if (route.method == request.method)
        return without_folder(route.handle(*served_, request, *values), folder());
      is_other_method = true;
    }
  if (is_other_method)
    return error_response(405, "not_allowed", "this method is not supported for this path",
                          "method");
  return error_response(404, "not_found", "not found", "path");
}

}  // namespace lefort::server
