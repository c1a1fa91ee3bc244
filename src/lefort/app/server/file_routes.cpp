#include <lefort/app/server/named_files.h>
#include <lefort/app/server/request_parts.h>
#include <lefort/app/server/route.h>
#include <lefort/app/server/served_case.h>

#include <fmt/format.h>

#include <system_error>

namespace lefort::app::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Reply get_files(ServedCase& served, const Request&, const PathValues&) {
  json list = json::array();
  for (const NamedFile& file : named_files()) {
    std::error_code error;
    const auto bytes = fs::file_size(file.path(served.folder), error);
    if (error) continue;
    list.push_back({{"name", file.name}, {"bytes", bytes}, {"stage", file.stage}});
  }
  return json_reply({{"files", list}});
}

Reply get_file(ServedCase& served, const Request&, const PathValues& values) {
  const NamedFile* const file = find_named(named_files(), values[0]);
  if (file == nullptr) return not_there("there is no file of that name");
  const fs::path path = file->path(served.folder);
  if (!there_is(path)) return not_there("there is no such file yet");
  Reply reply;
  reply.type = "application/octet-stream";
  reply.file = path;
  reply.headers.emplace_back("Content-Disposition",
                             fmt::format("attachment; filename=\"{}\"", file->name));
  return reply;
}

}  // namespace

std::span<const Route> file_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/files", get_files},
                                      {"GET", "/files/{file}", get_file}};
  return kRoutes;
}

}  // namespace lefort::app::server
