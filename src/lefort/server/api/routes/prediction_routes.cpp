#include <lefort/compare/compare_by_region.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/predicted_poses.h>
#include <lefort/io/surface_files.h>
#include <lefort/pipeline/compare/compare_tables.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/served_case.h>
#include <lefort/server/case/surface_encoding.h>

#include <algorithm>
#include <string>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kMaxSteps = 1000;  // As in the contract.
constexpr const char* kNoStep = "no such step";

Response get_prediction(ServedCase& served, const Request& request, const PathValues&) {
  const fs::path failure = served.folder.prediction() / "failure.json";
  const fs::path file =
      there_is(failure) ? failure : served.folder.prediction() / "prediction.json";
  const auto etag = served.folder.etag(file);
  if (!etag) return not_found("the case has no prediction");
  if (is_not_modified(request, etag)) return not_modified(etag);
  const json document = read_object(file);
  json steps = json::array();
  try {
    for (const json& step : document.at("steps")) {
      const auto where = io::predicted_poses(document, step);
      if (!where) return error_response(422, "invalid", where.error().message);
      const json& contact = step.at("contact");
      json poses = json::object();
      for (const auto& [segment, X_LB] : *where) poses[segment] = pipeline::as_json(X_LB);
      std::size_t iterations = 0;
      for (const json& attempt : step.at("attempts"))
        iterations += std::max<std::size_t>(attempt.at("newton").size(), 1) - 1;
      steps.push_back({{"step", steps.size() + 1},
                       {"path_fraction", step.at("path_fraction")},
                       {"pose", pipeline::as_json(where->front().X_LB)},
                       {"poses", poses},
                       {"newton_iterations", iterations},
                       {"relative_residual", step.at("relative_residual")},
                       {"contact_nodes", contact.at("nodes")},
                       {"contact_area_mm2", contact.at("area_mm2")},
                       {"p99_penetration_increase_mm", contact.at("p99_penetration_increase_mm")},
                       {"max_penetration_increase_mm", contact.at("max_penetration_increase_mm")},
                       {"max_displacement_mm", step.at("max_displacement_mm")}});
    }
    const bool converged = document.at("converged").get<bool>();
    const json& skin = document.at("skin");
    return with_etag(
        json_response(
            {{"converged", converged},
             {"failure", document.value("failure", "")},
             {"skin_max_shift_mm", converged ? skin.at("max_shift_mm") : json()},
             {"skin_mean_shift_mm", converged ? skin.at("mean_shift_where_moved_mm") : json()},
             {"elements", document.at("mesh").at("elements")},
             {"steps", steps},
             {"document", document}}),
        etag);
  } catch (const json::exception&) {
    return error_response(422, "invalid", "prediction.json is damaged: predict again");
  }
}

/// \returns kFileNotFound if there is no such step.
Result<std::vector<Vec3>> step_displacement(ServedCase& served, const std::string& step) {
  const auto number = number_of(step, 1, kMaxSteps);
  const auto etag = served.folder.etag(served.folder.prediction() / "prediction.json");
  if (!number || !etag) return fail(ErrorCode::kFileNotFound, kNoStep);
  LEFORT_TRY(const auto ct, served.volume());
  LEFORT_TRY(const auto steps, served.step_skins.get("steps", *etag, [&] {
    return io::StepSkin::read(served.folder.prediction(), ct->grid.spacing_mm);
  }));
  return steps->displacement_mm(*number);
}

Response refusal_of_step(const Error& error) {
  return error.code == ErrorCode::kFileNotFound ? not_found(kNoStep) : error_response(error);
}

Response get_prediction_step(ServedCase& served, const Request&, const PathValues& values) {
  const auto displacement_mm = step_displacement(served, values[0]);
  if (!displacement_mm) return refusal_of_step(displacement_mm.error());
  return binary_response(shared_bytes(encode_floats(*displacement_mm)));
}

/// Regions of the face from the case's landmarks, and those without their landmarks.
struct RegionsFound {
  compare::FaceRegions regions;
  std::vector<std::string> missing;
};

Result<RegionsFound> find_regions(const CaseFolder& folder) {
  plan::Landmarks landmarks;
  if (there_is(folder.landmarks())) {
    LEFORT_TRY(landmarks, io::read_landmarks(folder.landmarks()));
  }
  auto regions = compare::FaceRegions::from(landmarks);
  if (regions) return RegionsFound{*regions, regions->missing()};
  // Contradictory landmarks: only the whole face is measured.
  LEFORT_TRY(const auto none, compare::FaceRegions::from({}));
  return RegionsFound{none, {regions.error().message}};
}

Response get_prediction_step_regions(ServedCase& served, const Request&, const PathValues& values) {
  const auto displacement_mm = step_displacement(served, values[0]);
  if (!displacement_mm) return refusal_of_step(displacement_mm.error());
  const auto found = find_regions(served.folder);
  if (!found) return error_response(found.error());
  const auto before = io::read_surface(served.folder.prediction() / "skin_before.vtp");
  if (!before || before->vertices.size() != displacement_mm->size())
    return error_response(422, "invalid", "the prediction's files are damaged: predict again");
  json regions = json::array();
  for (const auto& row : compare::movement_by_region(*before, *displacement_mm, found->regions))
    regions.push_back({{"region", row.region}, {"shift", pipeline::statistics_json(row.face)}});
  return json_response({{"step", *number_of(values[0], 1, kMaxSteps)},
                        {"regions", regions},
                        {"missing", found->missing}});
}

}  // namespace

std::span<const Route> prediction_routes() {
  static constexpr Route kRoutes[] = {
      {"GET", "/prediction", get_prediction},
      {"GET", "/prediction/steps/{step}", get_prediction_step},
      {"GET", "/prediction/steps/{step}/regions", get_prediction_step_regions}};
  return kRoutes;
}

}  // namespace lefort::server
