#include <lefort/pipeline/json/newton_json.h>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const fem::LoadAttempt& attempt) {
  Json iterations = Json::array();
  for (const fem::NewtonIterate& iterate : attempt.history)
    iterations.push_back(
        {{"residual_n", iterate.residual_n},
         {"force_scale_n", iterate.residual_reference_n},
         {"relative_residual", iterate.residual_reference_n > 0.0
                                   ? iterate.residual_n / iterate.residual_reference_n
                                   : 0.0},
         {"energy_mj", iterate.energy_mj},
         {"step_length", iterate.step_length},
         {"convex_share", iterate.tangent_blend},
         {"shift", iterate.diagonal_shift},
         {"contact_points", iterate.contacts}});
  return {{"from", attempt.t_from},
          {"to", attempt.t_to},
          {"extrapolated", attempt.extrapolated},
          {"converged", attempt.stop == fem::NewtonStop::kConverged},
          {"reason", attempt.reason},
          {"newton", iterations}};
}

}  // namespace

Json attempts_json(const std::vector<fem::LoadAttempt>& attempts) {
  Json list = Json::array();
  for (const fem::LoadAttempt& attempt : attempts) list.push_back(as_json(attempt));
  return list;
}

Json contact_json(const contact::ContactStatistics& contact) {
  return {{"points", contact.points},
          {"nodes", contact.nodes},
          {"area_mm2", contact.area_mm2},
          {"max_penetration_mm", contact.max_penetration_mm},
          {"mean_penetration_mm", contact.mean_penetration_mm},
          {"max_depth_from_rest_mm", contact.max_depth_from_rest_mm},
          {"mean_depth_from_rest_mm", contact.mean_depth_from_rest_mm},
          {"p99_depth_from_rest_mm", contact.p99_depth_from_rest_mm},
          {"tunnelled_area_mm2", contact.tunnelled_area_mm2},
          {"force_n", {contact.force_L_n.x(), contact.force_L_n.y(), contact.force_L_n.z()}},
          {"normal_force_n", contact.normal_force_n}};
}

}  // namespace lefort::pipeline
