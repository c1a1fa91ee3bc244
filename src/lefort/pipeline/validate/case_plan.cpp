#include <lefort/core/units.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/validate/case_plan.h>
#include <lefort/plan/make_keyframes.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMaxCasePlan = 4 << 20;  // Bytes, as io/plan_file.

/// Of a case without a plan: its mandible was moved.
constexpr const char* kMandiblePlan = R"({
  "lefort_plan": 1,
  "title": "Mandible as a whole, moved as found after surgery",
  "segments": [{"name": "mandible", "osteotomy": {"bone": "mandible"}}]
})";

Json numbers(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// Gives each segment without a path one on which it stays in place.
std::vector<bool> fill_paths(Json& plan) {
  std::vector<bool> lacks_movement;
  const auto segments = plan.find("segments");
  if (segments == plan.end() || !segments->is_array()) return lacks_movement;
  for (Json& segment : *segments) {
    lacks_movement.push_back(segment.is_object() && !segment.contains("path"));
    if (lacks_movement.back()) segment["path"] = {{"keyframes", Json::array({Json::object()})}};
  }
  return lacks_movement;
}

void set_element_size(Json& plan, double size_mm) {
  Json& tissue = plan["tissue"];
  tissue["element_size_mm"] = size_mm;
  tissue["far_element_size_mm"] = std::max(tissue.value("far_element_size_mm", 0.0), 2.0 * size_mm);
}

/// Endings that say more than the last one alone.
std::string ending_of(const fs::path& file) {
  const std::string last = file.extension().string();
  const std::string before = file.stem().extension().string();
  const bool is_double = before == ".seg" || before == ".mrk" || before == ".nii";
  return is_double ? before + last : last;
}

/// Links each file that the plan names into the work folder, under its hash, and renames it in the
/// plan. The scan is not named: the prediction gets its path.
Result<void> link_inputs(Json& plan, const fs::path& work) {
  plan.erase("ct");
  Result<void> linked;
  const auto link = [&](const std::string& name) -> std::string {
    const fs::path file = work / name;
    const Result<std::string> sha256 = io::sha256_of_file(file);
    if (!sha256) {
      linked = tl::unexpected(sha256.error());
      return name;
    }
    const std::string new_name = sha256->substr(0, 16) + ending_of(file);
    std::error_code error;
    const fs::path target = fs::canonical(file, error);
    fs::remove(work / new_name, error);
    fs::create_symlink(target, work / new_name, error);
    if (error)
      linked = fail(ErrorCode::kFileUnwritable,
                    fmt::format("an input cannot be linked: {}", error.message()));
    return new_name;
  };
  plan = Json::parse(io::rename_files(plan.dump(), link));
  return linked;
}

}  // namespace

Result<CasePlan> draft_plan(const CohortCase& one, const CaseFiles& files,
                            std::optional<double> element_size_mm,
                            const io::ParameterSet& parameters) {
  std::string text = kMandiblePlan;
  if (one.plan) {
    LEFORT_TRY(text, io::read_text(*one.plan, kMaxCasePlan));
  }
  LEFORT_TRY(text, io::change_plan(text, parameters));
  CasePlan plan;
  plan.json = Json::parse(text);  // change_plan() has parsed it.
  plan.lacks_movement = fill_paths(plan.json);
  const fs::path place = one.plan.value_or(one.folder / "plan.json");
  if (const auto valid = io::parse_plan(plan.json.dump(), place.parent_path()); !valid)
    return fail(valid.error().code, fmt::format("plan.json: {}", valid.error().message));
  plan.json = Json::parse(io::portable_plan(plan.json.dump(), place, files.scan, files.work));
  if (files.labels)
    plan.json["segmentation"]["labels"] = files.labels->lexically_relative(files.work).string();
  if (element_size_mm) set_element_size(plan.json, *element_size_mm);
  if (files.link_inputs) LEFORT_TRY_VOID(link_inputs(plan.json, files.work));
  return plan;
}

void set_movement(CasePlan& plan, std::size_t segment, const RigidTransform& X_LB,
                  const geometry::TriangleMesh& segment_B) {
  constexpr double kStep_mm = 1.0;
  constexpr int kMinSteps = 4, kMaxSteps = 60;
  const Vec3 center_B = geometry::bounding_box(segment_B).center();
  const geometry::Keyframe keyframe = plan::keyframe_of_pose(X_LB, center_B);
  double max_mm = 0.0;
  for (const Vec3& v : segment_B.vertices) max_mm = std::max(max_mm, (X_LB * v - v).norm());
  const Vec3 rotation_deg = keyframe.rotation_rad * degrees_from_radians(1.0);
  plan.json["segments"][segment]["path"] = {
      {"steps", std::clamp(int(std::ceil(max_mm / kStep_mm)), kMinSteps, kMaxSteps)},
      {"keyframes", Json::array({{{"translation_mm", numbers(keyframe.translation_mm)},
                                  {"rotation_deg", numbers(rotation_deg)},
                                  {"about_mm", numbers(keyframe.center_L)}}})}};
}

}  // namespace lefort::pipeline
