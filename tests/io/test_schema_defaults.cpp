/// \file
/// The schemas of plans and decks: each property is described, and its default is that of the
/// program.
#include <lefort/core/units.h>
#include <lefort/io/deck_file.h>
#include <lefort/io/deck_schema.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_schema.h>
#include <lefort/plan/osteotomy_template.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <string>

namespace lefort::io::test_schema_defaults {
namespace {

using Json = nlohmann::json;
/// Values by the path of a property, as "/solver/max_iterations".
using Defaults = std::map<std::string, Json>;

/// Calls `visit(path, property, is_required)` with each property of a schema.
template <class Visit>
void visit_properties(const Json& schema, const std::string& path, const Visit& visit) {
  if (schema.is_array())
    for (const Json& one : schema) visit_properties(one, path, visit);
  if (!schema.is_object()) return;
  for (const auto& [key, value] : schema.items()) {
    if (key == "default" || key == "examples") continue;
    if (key == "definitions") {
      for (const auto& [name, definition] : value.items())
        visit_properties(definition, "#" + name, visit);
    } else if (key != "properties") {
      visit_properties(value, path, visit);
    } else {
      const Json required = schema.value("required", Json::array());
      for (const auto& [name, property] : value.items()) {
        const std::string of_property = path + "/" + name;
        visit(of_property, property,
              std::find(required.begin(), required.end(), name) != required.end());
        visit_properties(property, of_property, visit);
      }
    }
  }
}

void expect_described(const char* schema) {
  visit_properties(Json::parse(schema), "",
                   [](const std::string& path, const Json& property, bool is_required) {
                     EXPECT_FALSE(property.value("title", "").empty()) << path;
                     const std::string description = property.value("description", "");
                     EXPECT_TRUE(description.ends_with('.')) << path;
                     EXPECT_FALSE(property.value("examples", Json::array()).empty()) << path;
                     EXPECT_TRUE(is_required || property.contains("default") ||
                                 description.find("f omitted") != std::string::npos)
                         << path << " does not say what holds if it is omitted";
                   });
}

/// Each default of the schema is in `defaults`, and the reverse.
void expect_defaults(const char* schema, Defaults defaults) {
  visit_properties(
      Json::parse(schema), "", [&](const std::string& path, const Json& property, bool) {
        const auto value = property.find("default");
        if (value == property.end() || *value == Json::object()) return;
        const auto known = defaults.find(path);
        ASSERT_NE(known, defaults.end()) << path << " has no default in this test";
        if (value->is_number())
          EXPECT_NEAR(value->get<double>(), known->second.get<double>(), 1e-12) << path;
        else
          EXPECT_EQ(*value, known->second) << path;
        defaults.erase(known);
      });
  for (const auto& [path, value] : defaults) ADD_FAILURE() << path << " has no default";
}

Json as_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

constexpr const char* kPlan = R"({
  "lefort_plan": 1,
  "segments": [{"name": "front",
                "osteotomy": {"planes": [{"point_mm": [1, 2, 3], "towards_segment": [0, -2, 0]}]},
                "path": {"keyframes": [{"translation_mm": [0, -1, 0]}]}}],
  "tissue": {"skin": {}}
})";

/// The material that a preset stands for.
bool is_preset(const std::string& preset, double young_mpa, double poisson) {
  Json plan = Json::parse(kPlan);
  plan["tissue"]["skin"]["material"] = preset;
  const predict::SkinOptions skin = *parse_plan(plan.dump(), ".").value().tissue.skin;
  return skin.young_mpa == young_mpa && skin.poisson == poisson;
}

TEST(SchemaDefaults, EachPropertyOfAPlanIsDescribed) { expect_described(kPlanSchema); }
TEST(SchemaDefaults, EachPropertyOfADeckIsDescribed) { expect_described(kDeckSchema); }

TEST(SchemaDefaults, OfAPlanAreThoseOfTheProgram) {
  const PlanFile plan = parse_plan(kPlan, ".").value();
  const plan::PlannedSegment& segment = plan.segments[0];
  const geometry::Keyframe frame;
  const plan::TemplateOptions cut;
  const std::string osteotomy = "/segments/osteotomy", keyframe = "/segments/path/keyframes";
  EXPECT_TRUE(is_preset("face-compressible", plan.tissue.young_mpa, plan.tissue.poisson));
  EXPECT_TRUE(
      is_preset("skin-barbarino-2011", plan.tissue.skin->young_mpa, plan.tissue.skin->poisson));
  EXPECT_EQ(segment.path.interpolation, geometry::Interpolation::kStraight);
  EXPECT_FALSE(plan.boundary.elevation_margin_mm);
  EXPECT_EQ(segment.path.keyframes[0].path_fraction, frame.path_fraction);
  EXPECT_FALSE(segment.osteotomy.planes[0].bounds);
  expect_defaults(
      kPlanSchema,
      {{"/title", plan.title},
       {"/segmentation/teeth", std::string(name_of(plan.teeth_source))},
       {"/segmentation/bone_hu", plan.segmentation.bone_hu},
       {"/segmentation/skin_hu", plan.segmentation.skin_hu},
       {"/segments/cut_from", segment.cut_from},
       {osteotomy + "/template/above_palate_mm", cut.above_palate_mm},
       {osteotomy + "/template/behind_palate_mm", cut.behind_palate_mm},
       {osteotomy + "/template/behind_rim_mm", cut.behind_rim_mm},
       {osteotomy + "/template/above_pogonion_mm", cut.above_pogonion_mm},
       {osteotomy + "/template/split_depth_mm", cut.split_depth_mm},
       {osteotomy + "/template/behind_molar_mm", cut.behind_molar_mm},
       {osteotomy + "/template/nerve_clearance_mm", cut.canal_clearance_mm},
       {osteotomy + "/kerf_mm", segment.osteotomy.kerf_mm},
       {osteotomy + "/anchor_points", Json::array()},
       {osteotomy + "/min_piece_ml", segment.cut.min_piece_ml},
       {osteotomy + "/min_piece_fraction", segment.cut.min_piece_fraction},
       {"/segments/path/steps", segment.path.steps},
       {"/segments/path/interpolation", "straight"},
       {keyframe + "/path_fraction", frame.path_fraction},
       {keyframe + "/translation_mm", as_json(frame.translation_mm)},
       {keyframe + "/rotation_deg", as_json(frame.rotation_rad)},
       {keyframe + "/about_mm", as_json(frame.center_L)},
       {keyframe + "/tolerance_mm", 1.0},  // Of read_segments.cpp.
       {"/tissue/material", "face-compressible"},
       {"/tissue/skin/thickness_mm", plan.tissue.skin->thickness_mm},
       {"/tissue/skin/layers", plan.tissue.skin->layers},
       {"/tissue/skin/material", "skin-barbarino-2011"},
       {"/tissue/element_size_mm", plan.tissue.element_size_mm},
       {"/tissue/element_order", plan.tissue.element_order},
       {"/tissue/far_element_size_mm", plan.tissue.far_element_size_mm},
       {"/tissue/margin_mm", plan.tissue.margin_mm},
       {"/boundary/interface", std::string(name_of(plan.boundary.interface))},
       {"/boundary/scan_boundary", std::string(name_of(plan.boundary.scan_boundary))},
       {"/boundary/cut_boundary", std::string(name_of(plan.boundary.cut_boundary))},
       {"/boundary/foundation_mm", plan.boundary.foundation_mm},
       {"/boundary/joint_margin_mm", plan.boundary.joint_margin_mm},
       {"/boundary/vestibule_mm", plan.boundary.vestibule_mm},
       {"/boundary/lip_tone_kpa", 1000.0 * plan.boundary.lip_tone_mpa},
       {"/boundary/lips", std::string(name_of(plan.boundary.lips))},
       {"/boundary/interface_layer_mm", plan.boundary.interface_layer_mm},
       {"/boundary/contact_snap_mm", plan.boundary.contact_snap_mm},
       {"/contact/obstacle", std::string(predict::name_of(plan.contact.obstacle))},
       {"/contact/detection", std::string(contact::name_of(plan.contact.detection))},
       {"/contact/integration", std::string(contact::name_of(plan.contact.integration))},
       {"/contact/penetration_tolerance_mm", *plan.contact.penetration_tolerance_mm},
       {"/field/resolution", plan.field.resolution},
       {"/field/tolerance_mm", plan.field.tolerance_mm},
       {"/solver/relative_tolerance", plan.solver.relative_tolerance},
       {"/solver/max_iterations", plan.solver.max_iterations},
       {"/solver/min_increment_ratio", plan.solver.min_increment_ratio},
       {"#planes/flip", false},
       {"#planes/bounded", false}});
}

TEST(SchemaDefaults, OfADeckAreThoseOfTheProgram) {
  const DeckFile file = parse_deck(R"({
    "lefort_deck": 1, "mesh": "block.vtu",
    "materials": [{"law": "neo-hookean", "young_kpa": 15, "poisson": 0.45}],
    "sets": {"base": {"plane": {"point_mm": [0, 0, 0], "normal": [0, 0, 1]}}},
    "displacements": [{"set": "base", "z_mm": 0}],
    "obstacles": [{"name": "ball", "file": "ball.stl", "faces": "z1", "keyframes": [{}]}]
  })",
                                   ".")
                            .value();
  const solve::Deck& deck = file.deck;
  const solve::Obstacle& ball = deck.obstacles[0];
  const geometry::Keyframe& frame = ball.path.keyframes[0];
  Json curve = Json::array();
  for (const auto& point : deck.displacements[0].curve.points)
    curve.push_back({point.time, point.factor});
  EXPECT_EQ(file.every, WriteEvery::kIncrement);
  EXPECT_EQ(deck.linear_solver.kind, linear::LinearSolverKind::kAutomatic);
  EXPECT_TRUE(file.fields.displacement && file.fields.stress && file.fields.volume_ratio &&
              file.fields.stretches && file.fields.energy && file.fields.contact);
  expect_defaults(
      kDeckSchema,
      {{"/title", file.title},
       {"/mm_per_unit", file.mm_per_unit},
       {"/sets/plane/within_mm", std::get<solve::NodesOnPlane>(deck.sets[0].nodes).within_mm},
       {"/materials/volumetric", "quadratic"},
       {"/displacements/curve", curve},
       {"/tractions/curve", curve},
       {"/pressures/curve", curve},
       {"/body_forces/curve", curve},
       {"/obstacles/stiffness_factor", ball.stiffness_factor},
       {"/obstacles/contact_snap_mm", ball.contact_snap_mm},
       {"/obstacles/detection", std::string(contact::name_of(ball.detection))},
       {"/obstacles/integration", std::string(contact::name_of(ball.integration))},
       {"/obstacles/resolution", file.obstacles[0].options.resolution},
       {"/steps/initial_increment", deck.steps.first_increment},
       {"/steps/min_increment", deck.steps.min_increment},
       {"/steps/max_increment", deck.steps.max_increment},
       {"/steps/growth_factor", deck.steps.growth_factor},
       {"/steps/target_iterations", deck.steps.target_iterations},
       {"/steps/max_attempts", deck.steps.max_attempts},
       {"/steps/times", deck.times},
       {"/newton/relative_tolerance", deck.newton.relative_tolerance},
       {"/newton/absolute_tolerance_n", deck.newton.absolute_tolerance_n},
       {"/newton/max_iterations", deck.newton.max_iterations},
       {"/linear_solver", "automatic"},
       {"/output/every", "increment"},
       {"/output/fields",
        {"displacement", "stress", "volume_ratio", "stretches", "energy", "contact"}},
       {"#keyframes/time", frame.path_fraction},
       {"#keyframes/translation_mm", as_json(frame.translation_mm)},
       {"#keyframes/rotation_deg", as_json(frame.rotation_rad)},
       {"#keyframes/about_mm", as_json(frame.center_L)}});
}

}  // namespace
}  // namespace lefort::io::test_schema_defaults
