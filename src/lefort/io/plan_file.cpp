#include <lefort/core/units.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/internal/read_contact.h>
#include <lefort/io/internal/read_segments.h>
#include <lefort/io/internal/validated_json.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_schema.h>
#include <lefort/io/read_text.h>

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace lefort::io {
namespace {

using internal::Json;
using internal::read;
using internal::section;
namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxPlan = 4 << 20;  // Bytes; a plan is a few kilobytes.

/// Young's modulus and Poisson's ratio of a law.
struct Elasticity {
  double young_mpa;
  double poisson;
};

/// Presets and their sources: docs/theory/materials.md. The schema knows no others.
Elasticity read_material(const Json& material) {
  if (!material.is_string())
    return {mpa_from_kpa(material["young_kpa"].get<double>()), material["poisson"].get<double>()};
  const auto name = material.get<std::string>();
  if (name == "skin-barbarino-2011") {
    const predict::SkinOptions preset;
    return {preset.young_mpa, preset.poisson};
  }
  return {mpa_from_kpa(15.0), name == "face-nazari-2010" ? 0.49 : 0.45};
}

/// Into the options of a tissue; they stay as they are where it names no material.
template <class Options>
void read_material_of(const Json& tissue, Options& options) {
  if (!tissue.contains("material")) return;
  const auto [young_mpa, poisson] = read_material(tissue["material"]);
  options.young_mpa = young_mpa;
  options.poisson = poisson;
}

void read_skin(const Json& skin, predict::SkinOptions& options) {
  read(skin, "thickness_mm", options.thickness_mm);
  read(skin, "layers", options.layers);
  read_material_of(skin, options);
}

void read_mucosa(const Json& mucosa, predict::MucosaOptions& options) {
  read(mucosa, "thickness_mm", options.thickness_mm);
  read_material_of(mucosa, options);
}

/// Landmarks of the skin on lips and nose (docs/guide/landmarks.md).
std::vector<Vec3> lips_and_nose(const plan::Landmarks& landmarks) {
  std::vector<Vec3> points_L;
  for (const char* const name : {"Prn", "Al-R", "Al-L", "Sn", "Ls", "Stm", "Ch-R", "Ch-L", "Li"})
    if (const auto p_L = plan::find_landmark(landmarks, name)) points_L.push_back(*p_L);
  return points_L;
}

Result<void> read_tissue(const Json& tissue, const plan::Landmarks& landmarks,
                         predict::TissueOptions& options) {
  read_material_of(tissue, options);
  if (tissue.contains("skin")) read_skin(tissue["skin"], options.skin.emplace());
  if (tissue.contains("mucosa")) read_mucosa(tissue["mucosa"], options.mucosa.emplace());
  if (tissue.contains("muscle")) read_material_of(tissue["muscle"], options.muscle.emplace());
  if (const auto size = tissue.find("lips_and_nose_element_size_mm"); size != tissue.end())
    options.face = {size->get<double>(), lips_and_nose(landmarks)};
  read(tissue, "element_size_mm", options.element_size_mm);
  options.far_element_size_mm = std::max(options.far_element_size_mm, options.element_size_mm);
  read(tissue, "far_element_size_mm", options.far_element_size_mm);
  read(tissue, "element_order", options.element_order);
  read(tissue, "margin_mm", options.margin_mm);
  if (options.face && options.face->element_size_mm > options.far_element_size_mm)
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("tissue.lips_and_nose_element_size_mm: {:g} is more than "
                            "far_element_size_mm, {:g}",
                            options.face->element_size_mm, options.far_element_size_mm));
  if (options.far_element_size_mm >= options.element_size_mm) return {};
  return fail(ErrorCode::kPlanInvalid,
              fmt::format("tissue.far_element_size_mm: {:g} is less than element_size_mm, {:g}",
                          options.far_element_size_mm, options.element_size_mm));
}

void read_boundary(const Json& boundary, predict::BoundaryOptions& options) {
  using predict::OuterBoundary;
  using predict::TissueInterface;
  const auto choose = [&](const char* key, const auto& values, auto& value) {
    for (const auto one : values)
      if (boundary.value(key, "") == name_of(one)) value = one;
  };
  choose(
      "interface",
      std::array{TissueInterface::kClinical, TissueInterface::kBonded, TissueInterface::kContact},
      options.interface);
  choose("lips", std::array{predict::Lips::kSeparate, predict::Lips::kJoined}, options.lips);
  for (const auto& [key, value] : {std::pair{"scan_boundary", &options.scan_boundary},
                                   std::pair{"cut_boundary", &options.cut_boundary}})
    choose(key,
           std::array{OuterBoundary::kRoller, OuterBoundary::kFree, OuterBoundary::kFixed,
                      OuterBoundary::kFoundation},
           *value);
  if (boundary.contains("elevation_margin_mm"))
    options.elevation_margin_mm = boundary["elevation_margin_mm"].get<double>();
  read(boundary, "joint_margin_mm", options.joint_margin_mm);
  read(boundary, "vestibule_mm", options.vestibule_mm);
  if (boundary.contains("lip_tone_kpa"))
    options.lip_tone_mpa = boundary["lip_tone_kpa"].get<double>() / 1000.0;
  read(boundary, "interface_layer_mm", options.interface_layer_mm);
  read(boundary, "foundation_mm", options.foundation_mm);
  read(boundary, "contact_snap_mm", options.contact_snap_mm);
}

/// Scan and labels.
PlanFile read_scan(const Json& json, const fs::path& folder) {
  PlanFile plan;
  read(json, "title", plan.title);
  if (json.contains("ct")) plan.ct = folder / json["ct"].get<std::string>();

  const Json& segmentation = section(json, "segmentation");
  read(segmentation, "bone_hu", plan.segmentation.bone_hu);
  read(segmentation, "skin_hu", plan.segmentation.skin_hu);
  if (segmentation.contains("labels"))
    plan.labels = folder / segmentation["labels"].get<std::string>();
  const std::string teeth = segmentation.value("teeth", name_of(plan.teeth_source));
  if (teeth == name_of(TeethSource::kNone) || teeth == name_of(TeethSource::kAuto)) {
    plan.teeth_source =
        teeth == name_of(TeethSource::kAuto) ? TeethSource::kAuto : TeethSource::kNone;
  } else {
    plan.teeth_source = TeethSource::kFile;
    plan.teeth = folder / teeth;
  }
  return plan;
}

bool has_auto_landmarks(const Json& json) {
  const auto landmarks = json.find("landmarks");
  return landmarks != json.end() && landmarks->is_string() &&
         landmarks->get<std::string>() == "auto";
}

Result<PlanFile> read_sections(const Json& json, const fs::path& folder) {
  PlanFile plan = read_scan(json, folder);
  if (has_auto_landmarks(json))
    return fail(ErrorCode::kPlanInvalid,
                "landmarks: \"auto\" is for `lefort plan check` and `lefort predict` with a scan; "
                "here, find them with `lefort landmarks --find` and name the file");
  if (json.contains("landmarks")) {
    LEFORT_TRY(plan.landmarks, internal::read_plan_landmarks(json["landmarks"], folder));
    LEFORT_TRY_VOID(plan::patient_left_axis(plan.landmarks));  // Whether names and sides fit.
  }
  LEFORT_TRY(plan.segments, internal::read_segments(json["segments"], plan.landmarks, folder));

  LEFORT_TRY_VOID(read_tissue(section(json, "tissue"), plan.landmarks, plan.tissue));
  const Json& boundary = section(json, "boundary");
  read_boundary(boundary, plan.boundary);
  if (boundary.contains("labels"))
    plan.boundary_labels = folder / boundary["labels"].get<std::string>();

  const Json& contact = section(json, "contact");
  if (const auto factor = contact.find("stiffness_factor"); factor != contact.end())
    plan.contact.stiffness_factor = factor->get<double>();
  internal::read_contact(contact, plan.contact);
  for (const predict::Obstacle known : {predict::Obstacle::kRegularized, predict::Obstacle::kBone})
    if (contact.value("obstacle", std::string()) == predict::name_of(known))
      plan.contact.obstacle = known;

  const Json& field = section(json, "field");
  read(field, "resolution", plan.field.resolution);
  read(field, "band_mm", plan.field.band_mm);
  read(field, "tolerance_mm", plan.field.tolerance_mm);

  const Json& solver = section(json, "solver");
  read(solver, "relative_tolerance", plan.solver.relative_tolerance);
  read(solver, "max_iterations", plan.solver.max_iterations);
  read(solver, "min_increment_ratio", plan.solver.min_increment_ratio);
  return plan;
}

fs::path folder_of(const fs::path& file) {
  std::error_code error;
  const fs::path absolute = fs::absolute(file, error);
  return (error ? file : absolute).parent_path();
}

Result<PlanText> parse_plan_of(const fs::path& file, std::string text) {
  Result<PlanFile> plan = parse_plan(text, folder_of(file));
  if (!plan)
    return fail(plan.error().code, fmt::format("plan {}: {}", file.string(), plan.error().message));
  return PlanText{*std::move(plan), std::move(text)};
}

}  // namespace

Result<PlanFile> parse_plan(std::string_view text, const fs::path& folder) {
  LEFORT_TRY(internal::CheckedJson checked,
             internal::parse_checked(text, kPlanSchema, "the plan", deprecated_in_plans()));
  LEFORT_TRY(PlanFile plan, read_sections(checked.json, folder));
  plan.warnings = std::move(checked.warnings);
  return plan;
}

Result<void> check_plan_form(std::string_view text) {
  LEFORT_TRY_VOID(internal::parse_checked(text, kPlanSchema, "the plan", deprecated_in_plans()));
  return {};
}

Result<std::vector<std::string>> check_plan(std::string_view text, const fs::path& folder) {
  LEFORT_TRY(internal::CheckedJson checked,
             internal::parse_checked(text, kPlanSchema, "the plan", deprecated_in_plans()));
  if (!has_auto_landmarks(checked.json) && jaw_gaps(std::string(text)).empty())
    LEFORT_TRY_VOID(read_sections(checked.json, folder));
  return std::move(checked.warnings);
}

Result<std::string> rename_plan_keys(std::string_view text) {
  LEFORT_TRY(const internal::CheckedJson renamed,
             internal::parse_renamed(text, deprecated_in_plans()));
  return renamed.warnings.empty() ? std::string(text) : renamed.json.dump(2) + "\n";
}

Result<PlanText> read_plan_text(const fs::path& file) {
  LEFORT_TRY(std::string text, read_text(file, kMaxPlan));
  return parse_plan_of(file, std::move(text));
}

Result<std::optional<OpenPlan>> read_open_plan(const fs::path& file) {
  LEFORT_TRY(std::string text, read_text(file, kMaxPlan));
  const Result<internal::CheckedJson> checked =
      internal::parse_checked(text, kPlanSchema, "the plan", deprecated_in_plans());
  if (!checked)
    return fail(checked.error().code,
                fmt::format("plan {}: {}", file.string(), checked.error().message));
  const bool needs_landmarks = has_auto_landmarks(checked->json);
  if (!needs_landmarks && jaw_gaps(text).empty()) return std::nullopt;
  return OpenPlan{read_scan(checked->json, folder_of(file)), std::move(text), needs_landmarks};
}

std::string with_landmarks(const std::string& text, const plan::Landmarks& landmarks) {
  auto json = nlohmann::ordered_json::parse(text);
  auto points = nlohmann::ordered_json::object();
  for (const auto& [name, p_L] : landmarks) points[name] = {p_L.x(), p_L.y(), p_L.z()};
  json["landmarks"] = points;
  return json.dump(2) + "\n";
}

std::string with_teeth(const std::string& text, const std::string& teeth) {
  auto json = nlohmann::ordered_json::parse(text);
  const bool is_file = teeth != name_of(TeethSource::kNone) && teeth != name_of(TeethSource::kAuto);
  std::error_code error;
  const fs::path absolute = is_file ? fs::absolute(teeth, error) : fs::path(teeth);
  json["segmentation"]["teeth"] = error ? teeth : absolute.generic_string();
  return json.dump(2) + "\n";
}

std::vector<JawGap> jaw_gaps(const std::string& text) {
  std::vector<JawGap> gaps;
  const Json json = Json::parse(text);
  for (std::size_t segment = 0; segment < json["segments"].size(); ++segment) {
    const Json& path = json["segments"][segment]["path"];
    if (!path.contains("keyframes")) continue;
    for (std::size_t keyframe = 0; keyframe < path["keyframes"].size(); ++keyframe) {
      const Json& one = path["keyframes"][keyframe];
      if (!one.contains("autorotate")) continue;
      const Json& turn = one["autorotate"];
      // Both is an error that parsing reports.
      if (turn.contains("closing_deg") || turn.contains("gap_mm") == turn.contains("as")) continue;
      if (turn.contains("as") && turn.contains("to")) continue;
      gaps.push_back({segment, keyframe, turn.value("gap_mm", 0.0), turn.value("to", ""),
                      turn.value("as", "")});
    }
  }
  return gaps;
}

std::string with_closing(const std::string& text, const JawGap& gap, double closing_deg) {
  auto json = nlohmann::ordered_json::parse(text);
  json["segments"][gap.segment]["path"]["keyframes"][gap.keyframe]["autorotate"] = {
      {"closing_deg", closing_deg}};
  return json.dump(2) + "\n";
}

Result<PlanText> parse_completed_plan(const fs::path& file, std::string text) {
  return parse_plan_of(file, std::move(text));
}

Result<PlanFile> read_plan(const fs::path& file) {
  LEFORT_TRY(PlanText text, read_plan_text(file));
  return std::move(text.plan);
}

}  // namespace lefort::io
