#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/case_jobs.h>
#include <lefort/server/case/served_case.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::server {
namespace {

using nlohmann::json;

Response post_upload(ServedCase& served, const Request&, const PathValues&) {
  return served.uploads.begin();
}

Response put_upload_file(ServedCase& served, const Request& request, const PathValues& values) {
  const auto index = number_of(values[1], 0, served.uploads.limits().files - 1);
  if (!index) return error_response(422, "invalid", "the index must be a small integer", "index");
  const auto name = request.query.find("name");
  if (name == request.query.end())
    return error_response(422, "invalid", "the file's name must be given", "name");
  return served.uploads.put(values[0], *index, name->second, request);
}

Response delete_upload(ServedCase& served, const Request&, const PathValues& values) {
  return served.uploads.remove(values[0]);
}

Response get_jobs(ServedCase& served, const Request&, const PathValues&) {
  json list = json::array();
  for (const JobRecord& job : served.jobs.all()) list.push_back(as_json(job));
  return json_response({{"jobs", list}});
}

Response post_job(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "JobRequest");
  if (!body.value) return body.error;
  const std::string kind = (*body.value)["kind"];
  const auto kinds = job_kinds();
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    return error_response(501, "unavailable",
                          fmt::format("this version of lefort has no job {}", kind), "kind");
  body.value->erase("kind");
  const std::scoped_lock lock(served.writing);  // Not during a change that waits for jobs to end.
  const auto job = served.jobs.submit(kind, *std::move(body.value));
  if (!job) return error_response(429, "limit", job.error().message);
  return json_response(as_json(*job), 202);
}

Response get_job(ServedCase& served, const Request&, const PathValues& values) {
  const auto id = number_of(values[0], 1, 1'000'000'000);
  const auto job = id ? served.jobs.find(*id) : std::nullopt;
  return job ? json_response(as_json(*job)) : not_found("no such job");
}

Response get_job_iterates(ServedCase& served, const Request&, const PathValues& values) {
  const auto id = number_of(values[0], 1, 1'000'000'000);
  const auto history = id ? served.solve_history.of(*id) : std::nullopt;
  return history ? json_response(*history) : not_found("that job is not this server's last solve");
}

Response delete_job(ServedCase& served, const Request&, const PathValues& values) {
  const auto id = number_of(values[0], 1, 1'000'000'000);
  const auto job = id ? served.jobs.cancel(*id) : std::nullopt;
  return job ? json_response(as_json(*job)) : not_found("no such job");
}

Response get_events(ServedCase&, const Request& request, const PathValues&) {
  Response reply;
  reply.type = "text/event-stream";
  reply.events_after = request.header_or_empty("last-event-id");
  return reply;
}

}  // namespace

std::span<const Route> job_routes() {
  static constexpr Route kRoutes[] = {{"POST", "/uploads", post_upload},
                                      {"PUT", "/uploads/{upload}/files/{index}", put_upload_file},
                                      {"DELETE", "/uploads/{upload}", delete_upload},
                                      {"GET", "/jobs", get_jobs},
                                      {"POST", "/jobs", post_job},
                                      {"GET", "/jobs/{job}", get_job},
                                      {"DELETE", "/jobs/{job}", delete_job},
                                      {"GET", "/jobs/{job}/iterates", get_job_iterates},
                                      {"GET", "/events", get_events}};
  return kRoutes;
}

}  // namespace lefort::server
