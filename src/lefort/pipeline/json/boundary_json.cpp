#include <lefort/pipeline/json/boundary_json.h>
#include <lefort/predict/tissue_boundary.h>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json boundary_json(const PreparedCase& prepared) {
  const mesh::VolumeMesh& tissue = prepared.model.tissue;
  Json rules = Json::array();
  for (const predict::BoundaryRuleStatistics& rule :
       predict::boundary_rule_statistics(tissue, prepared.plan.boundary))
    rules.push_back({{"set", rule.set},
                     {"within_mm", rule.within_mm ? Json(*rule.within_mm) : Json(nullptr)},
                     {"fixed", rule.fixed},
                     {"with_segment", rule.with_segment},
                     {"free", rule.free},
                     {"painted_over", rule.painted},
                     {"area_mm2",
                      {{"fixed", rule.areas.fixed_mm2},
                       {"with_segment", rule.areas.with_segment_mm2},
                       {"free", rule.areas.free_mm2},
                       {"painted_over", rule.areas.painted_mm2}}}});
  Json painted = nullptr;
  if (prepared.plan.boundary_labels) {
    painted = {{"within_mm", predict::paint_reach_mm(prepared.scan_grid)},
               {"area_mm2", Json::object()}};
    for (const predict::BoundaryLabelStatistics& decision :
         predict::boundary_label_statistics(tissue)) {
      painted[decision.label.set] = decision.nodes;
      painted["area_mm2"][decision.label.name] = decision.area_mm2;
    }
  }
  return {{"elevation_margin_mm", prepared.plan.boundary.elevation_margin_mm},
          {"rules", rules},
          {"painted", painted}};
}

}  // namespace lefort::pipeline
