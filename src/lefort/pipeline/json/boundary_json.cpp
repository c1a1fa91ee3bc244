#include <lefort/pipeline/json/boundary_json.h>
#include <lefort/predict/boundary_areas.h>
#include <lefort/predict/tissue_boundary.h>

#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

/// Nodes and area of one condition set by one rule on one bone.
struct InterfaceGroup {
  Index nodes = 0;
  double area_mm2 = 0.0;
};

/// Condition of every boundary node, and sums by rule, condition and bone.
Json interface_json(const predict::FaceModel& model) {
  using Key = std::tuple<predict::InterfaceRule, predict::InterfaceCondition, std::int32_t>;
  const std::vector<predict::BoundaryNode> nodes = predict::boundary_nodes(model.tissue);
  std::map<Key, InterfaceGroup> groups;
  std::string conditions, rules;
  Json numbers = Json::array();
  for (const predict::NodeInterface& one : model.interface.nodes) {
    InterfaceGroup& group = groups[{one.rule, one.condition, one.bone}];
    ++group.nodes;
    group.area_mm2 += nodes[std::size_t(one.node)].area_mm2;
    conditions += predict::style_of(one.condition).letter;
    rules += predict::style_of(one.rule).letter;
    numbers.push_back(one.node);
  }
  Json table = Json::array();
  for (const auto& [key, group] : groups) {
    const auto& [rule, condition, bone] = key;
    table.push_back({{"rule", predict::style_of(rule).name},
                     {"condition", predict::style_of(condition).name},
                     {"segment", bone >= 0 ? Json(bone) : Json(nullptr)},
                     {"on_stationary_bone", bone == predict::kStationaryBone},
                     {"nodes", group.nodes},
                     {"area_mm2", group.area_mm2}});
  }
  Json letters = {{"conditions", Json::object()}, {"rules", Json::object()}};
  for (const auto& style : predict::kInterfaceConditions)
    letters["conditions"][std::string(1, style.letter)] = style.name;
  for (const auto& style : predict::kInterfaceRules)
    letters["rules"][std::string(1, style.letter)] = style.name;
  return {{"groups", table},
          {"letters", letters},
          {"nodes", numbers},
          {"condition_of_nodes", conditions},
          {"rule_of_nodes", rules}};
}

Json lips_json(const PreparedCase& prepared) {
  const predict::LipSlit& lips = prepared.model.lips;
  Json json{{"setting", name_of(prepared.plan.boundary.lips)},
            {"separated", lips.is_separated()},
            {"reason", lips.is_separated() ? Json(nullptr) : Json(lips.reason)},
            {"found_by", nullptr},
            {"confidence", nullptr},
            {"crease_depth_mm", nullptr},
            {"width_mm", nullptr},
            {"area_mm2", lips.area_mm2},
            {"pairs", lips.pairs.size()},
            {"rms_distance_mm", lips.rms_distance_mm}};
  if (!lips.fissure) return json;
  json["found_by"] = predict::name_of(lips.fissure->source);
  json["confidence"] = lips.fissure->confidence;
  json["crease_depth_mm"] = lips.fissure->crease_depth_mm;
  json["width_mm"] = lips.fissure->width_mm();
  return json;
}

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
    painted = {{"within_mm", predict::max_paint_distance_mm(prepared.scan_grid)},
               {"area_mm2", Json::object()}};
    for (const predict::BoundaryLabelStatistics& decision :
         predict::boundary_label_statistics(tissue)) {
      painted[decision.label.set] = decision.nodes;
      painted["area_mm2"][decision.label.name] = decision.area_mm2;
    }
  }
  return {{"rules", rules},
          {"painted", painted},
          {"interface", interface_json(prepared.model)},
          {"lips", lips_json(prepared)}};
}

}  // namespace lefort::pipeline
