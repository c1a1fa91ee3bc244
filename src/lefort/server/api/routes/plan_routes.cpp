#include <lefort/geometry/rigid_path.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/served_case.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace lefort::server {
namespace {

using nlohmann::json;

constexpr const char* kTraceCanals = "trace the canals of the nerves first, in step 9";

/// A refused plan, without the path of the case.
Response refused_plan(const ServedCase& served, std::string message, std::string_view where) {
  const std::string root = served.folder.root().string() + "/";
  for (std::size_t at = message.find(root); at != std::string::npos; at = message.find(root))
    message.erase(at, root.size());
  return error_response(422, "invalid", message, where);
}

Response get_plan(ServedCase& served, const Request& request, const PathValues&) {
  const auto etag = served.folder.etag(served.folder.plan());
  if (!etag) return not_found("the case has no plan");
  if (is_not_modified(request, etag)) return not_modified(etag);
  auto text = io::read_text(served.folder.plan(), kMaxDocument);
  if (!text) return error_response(text.error());
  Response reply;  // The page knows no deprecated keys.
  reply.text = io::rename_plan_keys(*text).value_or(*text);
  return with_etag(std::move(reply), etag);
}

Response put_plan(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "Plan");
  if (!body.value) return body.error;
  if (const auto files = check_files_of_plan(body.text); !files)
    return error_response(files.error());
  if (names_canals(body.text) && !there_is(served.folder.root() / kNerveFile))
    return error_response(422, "invalid", kTraceCanals, "plan");
  const auto plan = io::parse_plan(body.text, served.folder.root());
  if (!plan) return refused_plan(served, plan.error().message, "plan");
  const std::scoped_lock lock(served.writing);
  if (names_boundary(*body.value) && !there_is(served.folder.boundary()))
    return error_response(422, "invalid", "boundary.labels: no boundary conditions are painted",
                          "plan");
  if (auto refused = check_precondition(request, served.folder.etag(served.folder.plan())))
    return *refused;
  if (const auto written = io::write_text(served.folder.plan(), body.text); !written)
    return error_response(written.error());
  if (const auto recorded = served.folder.record_scan("plan"); !recorded)
    return error_response(recorded.error());
  served.report_stages();
  json names = json::array();
  for (const plan::PlannedSegment& segment : plan->segments)
    names.push_back(segment.osteotomy.segment);
  return with_etag(json_response({{"segments", names}}), served.folder.etag(served.folder.plan()));
}

Response get_plan_poses(ServedCase& served, const Request& request, const PathValues&) {
  const auto count = query_number(request, "count", 12, 1, 1000);
  if (!count) return error_response(count.error(), "count");
  const auto text = io::read_text(served.folder.plan(), kMaxDocument);
  if (!text) return not_found("the case has no plan");
  if (const auto files = check_files_of_plan(*text); !files) return error_response(files.error());
  const auto plan = io::parse_plan(*text, served.folder.root());
  if (!plan) return refused_plan(served, plan.error().message, "plan");
  json segments = json::object();
  for (const plan::PlannedSegment& segment : plan->segments) {
    json poses = json::array();
    for (int k = 0; k <= *count; ++k)
      poses.push_back(pipeline::as_json(geometry::pose_at(segment.path, double(k) / *count)));
    segments[segment.osteotomy.segment] = std::move(poses);
  }
  return json_response({{"count", *count}, {"segments", segments}});
}

/// The osteotomy of a request as that of a plan.
json osteotomy_of(const json& request) {
  json osteotomy{{"template", request["template"]}};
  if (!request.value("keep_canals", false)) return osteotomy;
  json& cut = osteotomy["template"];
  if (cut.is_string()) cut = {{"kind", cut}};
  cut["nerve"] = kNerveFile;
  osteotomy["kerf_mm"] = request.value("kerf_mm", 0.0);
  return osteotomy;
}

Response post_osteotomy(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "OsteotomyRequest");
  if (!body.value) return body.error;
  if (body.value->value("keep_canals", false) && served.folder.stage("nerve")["state"] != "fresh")
    return error_response(422, "invalid", kTraceCanals, "keep_canals");
  // Read as a plan reads it.
  const json plan_json{{"lefort_plan", 1},
                       {"landmarks", (*body.value)["landmarks"]},
                       {"segments",
                        {{{"name", "segment"},
                          {"osteotomy", osteotomy_of(*body.value)},
                          {"path", {{"keyframes", {{{"path_fraction", 1}}}}}}}}}};
  const auto plan = io::parse_plan(plan_json.dump(), served.folder.root());
  if (!plan) return refused_plan(served, plan.error().message, "template");
  const auto as_planes = [](const std::vector<plan::CutPlane>& planes) {
    json list = json::array();
    for (const plan::CutPlane& plane : planes)
      list.push_back({{"point_mm", pipeline::as_json(plane.point_L)},
                      {"towards_segment", pipeline::as_json(plane.normal_L)}});
    return list;
  };
  const plan::Osteotomy& cut = plan->segments.front().osteotomy;
  json osteotomy{{"planes", as_planes(cut.planes)}};
  for (const plan::CutRegion& region : cut.additional_regions)
    osteotomy["additional_regions"].push_back({{"planes", as_planes(region.planes)}});
  for (const Vec3& point : cut.anchor_points_L)
    osteotomy["anchor_points"].push_back(pipeline::as_json(point));
  return json_response({{"osteotomy", osteotomy}});
}

}  // namespace

std::span<const Route> plan_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/plan", get_plan},
                                      {"PUT", "/plan", put_plan},
                                      {"GET", "/plan/poses", get_plan_poses},
                                      {"POST", "/osteotomies", post_osteotomy}};
  return kRoutes;
}

}  // namespace lefort::server
