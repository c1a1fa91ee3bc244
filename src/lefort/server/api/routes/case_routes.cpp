#include <lefort/core/version.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/case_jobs.h>
#include <lefort/server/case/served_case.h>

namespace lefort::server {
namespace {

using nlohmann::json;

Response get_case(ServedCase& served, const Request&, const PathValues&) {
  const json description = served.folder.describe();
  const bool has_scan = there_is(served.folder.ct()) && description.contains("scan");
  return json_response({{"lefort_case", 1},
                        {"title", description.value("title", "")},
                        {"version", kVersion},
                        {"notice", kNotForClinicalUse},
                        {"start", served.events.start()},
                        {"scan", has_scan ? description["scan"] : json()},
                        {"stages", served.stages()},
                        {"example_available", served.example.has_value()},
                        {"job_kinds", job_kinds()},
                        {"limits",
                         {{"upload_file_bytes", served.uploads.limits().file_bytes},
                          {"upload_files", served.uploads.limits().files},
                          {"json_bytes", kMaxBody}}}});
}

}  // namespace

std::span<const Route> case_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/case", get_case}};
  return kRoutes;
}

}  // namespace lefort::server
