#include <lefort/io/landmarks_file.h>
#include <lefort/pipeline/plan/cephalometric_table.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/served_case.h>

#include <system_error>
#include <utility>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

plan::Landmarks as_landmarks(const json& points) {
  plan::Landmarks landmarks;
  for (const auto& [name, point] : points.items())
    landmarks.push_back({name, Vec3(point[0], point[1], point[2])});
  return landmarks;
}

json as_points(const plan::Landmarks& landmarks) {
  json points = json::object();
  for (const plan::Landmark& landmark : landmarks)
    points[landmark.name] = {landmark.point_L.x(), landmark.point_L.y(), landmark.point_L.z()};
  return points;
}

Response get_landmarks(ServedCase& served, const Request& request, const PathValues&) {
  const auto etag = served.folder.etag(served.folder.landmarks());
  if (!etag) return not_found("the case has no landmarks");
  if (is_not_modified(request, etag)) return not_modified(etag);
  const auto landmarks = io::read_landmarks(served.folder.landmarks());
  if (!landmarks) return error_response(landmarks.error());
  return with_etag(json_response({{"landmarks", as_points(*landmarks)}}), etag);
}

Response put_landmarks(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "Landmarks");
  if (!body.value) return body.error;
  plan::Landmarks landmarks = as_landmarks((*body.value)["landmarks"]);
  const std::scoped_lock lock(served.writing);
  if (auto refused = check_precondition(request, served.folder.etag(served.folder.landmarks())))
    return *refused;
  if (landmarks.empty()) {
    std::error_code error;
    fs::remove(served.folder.landmarks(), error);
  } else {
    const auto checked = io::checked_landmarks(std::move(landmarks));
    if (!checked) return error_response(checked.error(), "landmarks");
    if (const auto written = io::write_landmarks(served.folder.landmarks(), *checked); !written)
      return error_response(written.error());
    if (const auto recorded = served.folder.record_scan("landmarks"); !recorded)
      return error_response(recorded.error());
  }
  served.report_stages();
  return with_etag(json_response(*body.value), served.folder.etag(served.folder.landmarks()));
}

Response post_measurements(ServedCase&, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "MeasurementsRequest");
  if (!body.value) return body.error;
  const auto before = plan::measure(as_landmarks((*body.value)["before"]));
  if (!before) return error_response(before.error(), "before");
  std::vector<plan::Measurement> after_table;
  if (body.value->contains("after")) {
    auto after = plan::measure(as_landmarks((*body.value)["after"]));
    if (!after) return error_response(after.error(), "after");
    after_table = *std::move(after);
  }
  return json_response({{"measurements", pipeline::cephalometric_json(*before, after_table)}});
}

}  // namespace

std::span<const Route> landmark_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/landmarks", get_landmarks},
                                      {"PUT", "/landmarks", put_landmarks},
                                      {"POST", "/measurements", post_measurements}};
  return kRoutes;
}

}  // namespace lefort::server
