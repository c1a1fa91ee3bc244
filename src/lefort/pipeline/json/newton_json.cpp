#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/json/newton_json.h>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const fem::LoadAttempt& attempt) {
  Json iterations = Json::array();
  for (const fem::NewtonIterate& iterate : attempt.history)
    iterations.push_back(
        {{"residual_n", iterate.residual_n},
         {"residual_reference_n", iterate.residual_reference_n},
         {"relative_residual", iterate.residual_reference_n > 0.0
                                   ? iterate.residual_n / iterate.residual_reference_n
                                   : 0.0},
         {"energy_mj", iterate.energy_mj},
         {"step_length", iterate.step_length},
         {"tangent_blend", iterate.tangent_blend},
         {"diagonal_shift", iterate.diagonal_shift},
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
          {"max_penetration_increase_mm", contact.max_penetration_increase_mm},
          {"mean_penetration_increase_mm", contact.mean_penetration_increase_mm},
          {"p99_penetration_increase_mm", contact.p99_penetration_increase_mm},
          {"max_bone_penetration_increase_mm", contact.max_bone_penetration_increase_mm},
          {"p99_bone_penetration_increase_mm", contact.p99_bone_penetration_increase_mm},
          {"force_n", as_json(contact.force_L_n)},
          {"normal_force_n", contact.normal_force_n}};
}

}  // namespace lefort::pipeline
