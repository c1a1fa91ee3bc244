#include <lefort/app/server/request_parts.h>
#include <lefort/app/server/route.h>
#include <lefort/app/server/served_case.h>
#include <lefort/app/server/surface_bytes.h>

#include <algorithm>

namespace lefort::app::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Reply get_prediction(ServedCase& served, const Request& request, const PathValues&) {
  const fs::path failure = served.folder.prediction() / "failure.json";
  const fs::path file =
      there_is(failure) ? failure : served.folder.prediction() / "prediction.json";
  const auto etag = served.folder.etag(file);
  if (!etag) return not_there("there is no prediction yet");
  if (is_known(request, etag)) return not_modified(etag);
  const json document = read_object(file);
  json steps = json::array();
  try {
    for (const json& step : document.at("steps")) {
      json pose = json::array();
      for (const json& row : step.at("pose_4x4_row_major_mm_lps"))
        for (const json& number : row) pose.push_back(number);
      std::size_t iterations = 0;
      for (const json& attempt : step.at("attempts"))
        iterations += std::max<std::size_t>(attempt.at("newton").size(), 1) - 1;
      steps.push_back({{"step", steps.size() + 1},
                       {"share", step.at("share")},
                       {"pose", pose},
                       {"newton_iterations", iterations},
                       {"relative_residual", step.at("relative_residual")},
                       {"contact_nodes", step.at("contact_nodes")},
                       {"contact_area_mm2", step.at("contact_area_mm2")},
                       {"p99_depth_mm", step.at("p99_depth_from_rest_mm")},
                       {"max_depth_mm", step.at("max_depth_from_rest_mm")},
                       {"largest_displacement_mm", step.at("largest_displacement_mm")}});
    }
    const bool converged = document.at("converged").get<bool>();
    const json& skin = document.at("skin");
    return with_etag(
        json_reply(
            {{"converged", converged},
             {"failure", document.value("failure", "")},
             {"skin_largest_shift_mm", converged ? skin.at("largest_shift_mm") : json()},
             {"skin_mean_shift_mm", converged ? skin.at("mean_shift_where_moved_mm") : json()},
             {"elements", document.at("mesh").at("elements")},
             {"steps", steps},
             {"document", document}}),
        etag);
  } catch (const json::exception&) {
    return refusal(422, "invalid", "prediction.json is damaged: predict again");
  }
}

Reply get_prediction_step(ServedCase& served, const Request&, const PathValues& values) {
  const auto step = number_of(values[0], 1, 1000);
  const auto etag = served.folder.etag(served.folder.prediction() / "prediction.json");
  if (!step || !etag) return not_there("there is no such step");
  const auto ct = served.volume();
  if (!ct) return refusal(ct.error());
  const auto steps = served.kept_steps.get("steps", *etag, [&] {
    return StepSkin::read(served.folder.prediction(), (*ct)->grid.spacing_mm);
  });
  if (!steps) return refusal(steps.error());
  const auto displacement_mm = (*steps)->displacement_mm(*step);
  if (!displacement_mm) {
    if (displacement_mm.error().code == ErrorCode::kFileNotFound)
      return not_there("there is no such step");
    return refusal(displacement_mm.error());
  }
  return binary_reply(shared_bytes(float_bytes(*displacement_mm)));
}

}  // namespace

std::span<const Route> prediction_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/prediction", get_prediction},
                                      {"GET", "/prediction/steps/{step}", get_prediction_step}};
  return kRoutes;
}

}  // namespace lefort::app::server
