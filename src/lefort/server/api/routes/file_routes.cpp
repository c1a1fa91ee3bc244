#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/served_case.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Response get_files(ServedCase& served, const Request&, const PathValues&) {
  json list = json::array();
  for (const NamedFile& file : file_catalog()) {
    std::error_code error;
    const auto bytes = fs::file_size(file.path(served.folder), error);
    if (error) continue;
    list.push_back({{"name", file.name}, {"bytes", bytes}, {"stage", file.stage}});
  }
  std::error_code error;
  std::vector<std::pair<std::string, std::uintmax_t>> of_segments;
  for (fs::directory_iterator entry(served.folder.prediction(), error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code unreadable;
    const std::string name = entry->path().filename().string();
    const auto bytes = entry->file_size(unreadable);
    if (!unreadable && segment_result(served.folder, name)) of_segments.emplace_back(name, bytes);
  }
  std::sort(of_segments.begin(), of_segments.end());
  for (const auto& [name, bytes] : of_segments)
    list.push_back({{"name", name}, {"bytes", bytes}, {"stage", "prediction"}});
  return json_response({{"files", list}});
}

Response get_file(ServedCase& served, const Request&, const PathValues& values) {
  const NamedFile* const file = find_named(file_catalog(), values[0]);
  const std::optional<fs::path> path =
      file != nullptr ? file->path(served.folder) : segment_result(served.folder, values[0]);
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
