#include <lefort/inverse/fit_preview.h>
#include <lefort/io/predicted_poses.h>
#include <lefort/io/surface_files.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/served_case.h>
#include <lefort/server/case/surface_encoding.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace lefort::server {
namespace {

using nlohmann::json;

constexpr const char* kPreviewNote = "preview, not a prediction";

/// Poses in a body that matches the contract, or the error response.
Result<Poses> as_poses(const json& poses) {
  constexpr double kRigid = 1e-5;  // Pages multiply in single precision.
  Poses result;
  for (const auto& [name, numbers] : poses.items()) {
    Eigen::Matrix4d matrix;
    for (int k = 0; k < 16; ++k) matrix(k / 4, k % 4) = numbers[std::size_t(k)].get<double>();
    const Mat3 turn = matrix.topLeftCorner<3, 3>();
    const bool is_rigid = matrix.allFinite() &&
                          (turn.transpose() * turn - Mat3::Identity()).norm() < kRigid &&
                          turn.determinant() > 0.0 &&
                          (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kRigid &&
                          matrix.topRightCorner<3, 1>().norm() < 1e5;
    if (!is_rigid)
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("poses.{} is not a rigid motion: rows of a 4 by 4 matrix, translation "
                      "in the last column",
                      name));
    RigidTransform pose = RigidTransform::Identity();
    pose.linear() = turn;
    pose.translation() = matrix.topRightCorner<3, 1>();
    result.emplace(name, pose);
  }
  return result;
}

Response post_poses(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "Poses");
  if (!body.value) return body.error;
  const auto poses = as_poses((*body.value)["poses"]);
  if (!poses) return error_response(poses.error(), "poses");
  const auto etag = served.folder.etag(served.folder.cut() / "cut.json");
  if (!etag) return error_response(409, "not_ready", "no bone is cut: run the job cut first");
  const auto bones = served.cached_bones.get("bones", *etag, [&] {
    return OverlapService::read(served.folder.cut(), served.folder.cache());
  });
  if (!bones) return error_response(bones.error());
  const auto depths = (*bones)->depths(*poses);
  if (!depths) return error_response(depths.error(), "poses");
  Response reply = binary_response(shared_bytes(encode_floats(depths->depth_mm)));
  std::string segments;
  for (const auto& [name, vertices] : depths->segments)
    segments += fmt::format("{}{}={}", segments.empty() ? "" : ",", name, vertices);
  reply.headers.emplace_back("X-Lefort-Segments", segments);
  reply.headers.emplace_back("X-Lefort-Deepest-Mm", fmt::format("{:.3f}", depths->deepest_mm));
  reply.headers.emplace_back("X-Lefort-Depth-Is-Lower-Bound",
                             depths->depth_is_lower_bound ? "1" : "0");
  return reply;
}

/// Segments in the plan's order; none if there is no preview.
std::vector<std::string> previewed_segments(ServedCase& served) {
  const json document = read_object(served.folder.preview() / "preview.json");
  std::vector<std::string> names;
  if (const auto list = document.find("segments"); list != document.end() && list->is_array())
    for (const json& name : *list)
      if (name.is_string()) names.push_back(name.get<std::string>());
  return names;
}

Response post_preview(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "PreviewRequest");
  if (!body.value) return body.error;
  const auto poses = as_poses((*body.value)["poses"]);
  if (!poses) return error_response(poses.error(), "poses");
  const auto segments = previewed_segments(served);
  if (segments.empty())
    return error_response(409, "not_ready", "no preview is prepared: run the job preview-factor");
  std::vector<RigidTransform> X_LB;
  for (const std::string& segment : segments)
    if (const auto pose = poses->find(segment); pose != poses->end()) X_LB.push_back(pose->second);
  if (poses->size() != segments.size() || X_LB.size() != segments.size())
    return error_response(
        422, "invalid",
        fmt::format("the preview is of segment {} alone", fmt::join(segments, " and ")), "poses");
  const auto face = served.preview();
  if (!face) return error_response(face.error());
  if ((*face)->segment_count() != segments.size())
    return error_response(422, "invalid", "the preview's files are damaged: prepare it again");
  const bool is_dragging = body.value->value("dragging", false);
  const auto displacement_mm =
      is_dragging ? (*face)->follow_mm(X_LB) : (*face)->displacement_mm(X_LB);
  if (!displacement_mm) return error_response(displacement_mm.error());
  Response reply = binary_response(shared_bytes(encode_floats(*displacement_mm)));
  reply.headers.emplace_back("X-Lefort-Note", kPreviewNote);
  return reply;
}

/// Directions of the names in a body that matches the contract.
std::vector<Vec3> as_axes(const json& free) {
  std::vector<Vec3> axes_L;
  for (const json& name : free) {
    if (name == "anterior") axes_L.push_back(-Vec3::UnitY());
    if (name == "superior") axes_L.push_back(Vec3::UnitZ());
    if (name == "left") axes_L.push_back(Vec3::UnitX());
  }
  return axes_L;
}

Response post_preview_fit(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "PreviewFitRequest");
  if (!body.value) return body.error;
  const json& wanted = *body.value;
  const auto poses = as_poses(wanted["poses"]);
  if (!poses) return error_response(poses.error(), "poses");
  const auto segments = previewed_segments(served);
  if (segments.empty())
    return error_response(409, "not_ready", "no preview is prepared: run the job preview-factor");
  std::vector<RigidTransform> X_LB;
  for (const std::string& segment : segments)
    if (const auto pose = poses->find(segment); pose != poses->end()) X_LB.push_back(pose->second);
  const auto moved = std::find(segments.begin(), segments.end(), wanted["segment"]);
  if (poses->size() != segments.size() || X_LB.size() != segments.size() || moved == segments.end())
    return error_response(
        422, "invalid",
        fmt::format("the preview is of segment {} alone", fmt::join(segments, " and ")), "poses");
  const auto face = served.preview();
  if (!face) return error_response(face.error());
  const json& mm = wanted["displacement_mm"];
  const auto fit = inverse::fit_preview(
      **face, X_LB, std::size_t(moved - segments.begin()), wanted["vertex"].get<Index>(),
      Vec3(mm[0].get<double>(), mm[1].get<double>(), mm[2].get<double>()), as_axes(wanted["free"]));
  if (!fit) return error_response(fit.error());
  return json_response({{"note", kPreviewNote},
                        {"pose", pipeline::as_json(fit->X_LB)},
                        {"displacement_mm", pipeline::as_json(fit->displacement_mm)},
                        {"residual_mm", fit->residual_mm},
                        {"at_limit", fit->is_at_limit}});
}

Response get_preview_distance(ServedCase& served, const Request&, const PathValues&) {
  if (!served.folder.etag(served.folder.prediction() / "prediction.json"))
    return error_response(409, "not_ready", "no prediction to compare the preview with");
  const auto face = served.preview();
  if (!face) return error_response(409, "not_ready", face.error().message);
  const auto before = io::read_surface(served.folder.prediction() / "skin_before.vtp");
  const auto after = io::read_surface(served.folder.prediction() / "predicted_skin.vtp");
  const json document = read_object(served.folder.prediction() / "prediction.json");
  const json last = document.find("steps") == document.end() || document["steps"].empty()
                        ? json()
                        : document["steps"].back();
  const auto poses = io::predicted_poses(document, last);
  if (!poses) return error_response(422, "invalid", poses.error().message);
  if (!before || !after || before->vertices.size() != after->vertices.size())
    return error_response(422, "invalid", "the prediction's files are damaged: predict again");
  std::vector<std::string> segments;
  std::vector<RigidTransform> X_LB;
  for (const auto& [segment, pose] : *poses) {
    segments.push_back(segment);
    X_LB.push_back(pose);
  }
  if (Index(before->vertices.size()) != (*face)->vertex_count())
    return error_response(409, "not_ready", "preview and prediction are of different skins");
  if (segments != previewed_segments(served) || X_LB.size() != (*face)->segment_count())
    return error_response(409, "not_ready", "preview and prediction are of different segments");
  const auto preview_mm = (*face)->displacement_mm(X_LB);
  if (!preview_mm) return error_response(preview_mm.error());
  const predict::PreviewDistance distance =
      predict::measure_preview(*preview_mm, before->vertices, after->vertices);
  return json_response({{"note", kPreviewNote},
                        {"moved_vertices", distance.moved_vertices},
                        {"p50_mm", distance.p50_mm},
                        {"p99_mm", distance.p99_mm},
                        {"max_mm", distance.max_mm},
                        {"max_shift_mm", distance.max_shift_mm}});
}

}  // namespace

std::span<const Route> movement_routes() {
  static constexpr Route kRoutes[] = {{"POST", "/poses", post_poses},
                                      {"POST", "/preview", post_preview},
                                      {"POST", "/preview/fit", post_preview_fit},
                                      {"GET", "/preview/distance", get_preview_distance}};
  return kRoutes;
}

}  // namespace lefort::server
