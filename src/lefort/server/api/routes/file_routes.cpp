#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/served_case.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Adds the files of a folder that have the names of `result`, in their order.
void add_results(json& list, const ServedCase& served, const fs::path& folder, const char* stage,
                 std::optional<fs::path> (*result)(const CaseFolder&, std::string_view)) {
  std::error_code error;
  std::vector<std::pair<std::string, std::uintmax_t>> found;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code unreadable;
    const std::string name = entry->path().filename().string();
    const auto bytes = entry->file_size(unreadable);
    if (!unreadable && result(served.folder, name)) found.emplace_back(name, bytes);
  }
  std::sort(found.begin(), found.end());
  for (const auto& [name, bytes] : found)
    list.push_back({{"name", name}, {"bytes", bytes}, {"stage", stage}});
}

Response get_files(ServedCase& served, const Request&, const PathValues&) {
  json list = json::array();
  for (const NamedFile& file : file_catalog()) {
    std::error_code error;
    const auto bytes = fs::file_size(file.path(served.folder), error);
    if (error) continue;
    list.push_back({{"name", file.name}, {"bytes", bytes}, {"stage", file.stage}});
  }
  add_results(list, served, served.folder.prediction(), "prediction", segment_result);
  add_results(list, served, served.folder.guides(), "guides", guide_result);
  return json_response({{"files", list}});
}

Response get_file(ServedCase& served, const Request&, const PathValues& values) {
  const NamedFile* const file = find_named(file_catalog(), values[0]);
  std::optional<fs::path> path =
      file != nullptr ? file->path(served.folder) : segment_result(served.folder, values[0]);
  if (!path) path = guide_result(served.folder, values[0]);
  if (!path) return not_found("no file of that name");
  if (!there_is(*path)) return not_found("this file does not exist yet");
  Response reply;
  reply.type = "application/octet-stream";
  reply.file = *path;
  reply.headers.emplace_back("Content-Disposition",
                             fmt::format("attachment; filename=\"{}\"", values[0]));
  return reply;
}

}  // namespace

std::span<const Route> file_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/files", get_files},
                                      {"GET", "/files/{file}", get_file}};
  return kRoutes;
}

}  // namespace lefort::server
