#include <lefort/core/units.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_schema.h>
#include <lefort/io/write_atomically.h>
#include <lefort/plan/bone_path.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lefort::io {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestPlan = 4 << 20;  // Bytes; a plan is a few kilobytes.

/// Listens to the parser, which takes the last of two equal keys without a word.
class DuplicateKeys {
 public:
  bool operator()(int /*depth*/, Json::parse_event_t event, const Json& value) {
    if (event == Json::parse_event_t::object_start) open_.emplace_back();
    if (event == Json::parse_event_t::object_end) open_.pop_back();
    if (event == Json::parse_event_t::key &&
        !open_.back().insert(value.get<std::string>()).second && !first_)
      first_ = value.get<std::string>();
    return true;
  }
  [[nodiscard]] const std::optional<std::string>& first() const { return first_; }

 private:
  std::vector<std::set<std::string>> open_;  ///< Keys of the objects begun and not ended.
  std::optional<std::string> first_;
};

Result<Json> parse_json(std::string_view text) {
  const auto refuse = [](std::string why) { return fail(ErrorCode::kPlanInvalid, std::move(why)); };
  DuplicateKeys duplicates;
  try {
    Json json = Json::parse(text, std::ref(duplicates));
    if (duplicates.first()) return refuse(fmt::format("key {} stands twice", *duplicates.first()));
    return json;
  } catch (const Json::parse_error& error) {
    return refuse(fmt::format("not JSON: {} (byte {})",
                              text.empty() ? "the file is empty" : "syntax error", error.byte));
  } catch (const Json::exception&) {  // A number that no double holds.
    return refuse("not JSON: a number is too large");
  }
}

/// `<root>`, `[segments]`, `[0]`, `[path]` becomes `segments[0].path`.
std::string readable_path(const std::vector<std::string>& context) {
  std::string path;
  for (const std::string& part : context) {
    if (part.size() < 3 || part.front() != '[') continue;
    const std::string key = part.substr(1, part.size() - 2);
    const bool is_index = key.find_first_not_of("0123456789") == std::string::npos;
    if (is_index) {
      path += part;
    } else {
      if (!path.empty()) path += '.';
      path += key;
    }
  }
  return path.empty() ? "the plan" : path;
}

/// The deepest cause among the validator's messages, in our words.
Error describe(const valijson::ValidationResults& results) {
  constexpr std::string_view kFollowUp = "Failed to validate ";  // Says that a child failed.
  constexpr std::string_view kUnknownKey = "Object contains a property that could not be validated";
  const valijson::ValidationResults::Error* cause = nullptr;
  for (const auto& error : results) {
    if (error.description.starts_with(kUnknownKey)) {
      const std::size_t quote = error.description.find(": '");
      return {ErrorCode::kPlanInvalid,
              fmt::format("{}: unknown key {}", readable_path(error.context),
                          error.description.substr(quote + 2))};
    }
    const bool is_cause = !error.description.starts_with(kFollowUp);
    if (is_cause && (cause == nullptr || error.context.size() > cause->context.size()))
      cause = &error;
  }
  if (cause == nullptr) return {ErrorCode::kPlanInvalid, "the plan breaks its schema"};
  std::string what = cause->description;
  if (!what.empty()) what.front() = char(std::tolower(what.front()));
  while (what.ends_with('.')) what.pop_back();
  return {ErrorCode::kPlanInvalid, fmt::format("{}: {}", readable_path(cause->context), what)};
}

Result<void> check_against_schema(const Json& json) {
  const Json schema_json = Json::parse(kPlanSchema);
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_json),
                                          schema);
  valijson::ValidationResults results;
  valijson::Validator validator;
  if (validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(json), &results))
    return {};
  return tl::unexpected(describe(results));
}

/// Sets `value` if the key is there; the schema has checked its type.
template <class T>
void read(const Json& object, const char* key, T& value) {
  if (const auto found = object.find(key); found != object.end()) value = found->get<T>();
}

void read(const Json& object, const char* key, Vec3& value) {
  if (const auto found = object.find(key); found != object.end())
    value = Vec3((*found)[0].get<double>(), (*found)[1].get<double>(), (*found)[2].get<double>());
}

/// An object of the plan, or an empty one.
Json section(const Json& plan, const char* key) { return plan.value(key, Json::object()); }

Result<plan::Osteotomy> read_osteotomy(const Json& segment) {
  plan::Osteotomy osteotomy;
  read(segment, "name", osteotomy.segment);
  const Json& planes = segment["osteotomy"]["planes"];
  for (std::size_t i = 0; i < planes.size(); ++i) {
    plan::CutPlane plane{Vec3::Zero(), Vec3::Zero()};
    read(planes[i], "point_mm", plane.point_L);
    read(planes[i], "towards_segment", plane.normal_L);
    const double length = plane.normal_L.norm();
    if (!(length > 1e-9))
      return fail(
          ErrorCode::kPlanInvalid,
          fmt::format("segments[0].osteotomy.planes[{}].towards_segment: the vector is zero", i));
    plane.normal_L /= length;
    osteotomy.planes.push_back(plane);
  }
  return osteotomy;
}

plan::BonePath read_path(const Json& segment) {
  plan::BonePath path;
  read(segment, "name", path.segment);
  const Json& json = segment["path"];
  read(json, "steps", path.steps);
  for (const Json& frame_json : json["keyframes"]) {
    plan::Keyframe frame;
    Vec3 rotation_deg = Vec3::Zero();
    read(frame_json, "at", frame.at);
    read(frame_json, "translation_mm", frame.translation_mm);
    read(frame_json, "rotation_deg", rotation_deg);
    read(frame_json, "about_mm", frame.centre_L);
    frame.rotation_rad = rotation_deg * radians_from_degrees(1.0);
    path.keyframes.push_back(frame);
  }
  return path;
}

/// Presets and their sources: docs/materials.md.
void read_material(const Json& tissue, predict::TissueOptions& options) {
  const auto material = tissue.find("material");
  if (material == tissue.end()) return;
  if (material->is_string()) {
    options.young_mpa = mpa_from_kpa(15.0);
    options.poisson = material->get<std::string>() == "face-nazari-2010" ? 0.49 : 0.45;
    return;
  }
  options.young_mpa = mpa_from_kpa((*material)["young_kpa"].get<double>());
  options.poisson = (*material)["poisson"].get<double>();
}

Result<void> read_tissue(const Json& tissue, predict::TissueOptions& options) {
  read_material(tissue, options);
  read(tissue, "element_size_mm", options.element_size_mm);
  options.far_element_size_mm = std::max(options.far_element_size_mm, options.element_size_mm);
  read(tissue, "far_element_size_mm", options.far_element_size_mm);
  read(tissue, "margin_mm", options.margin_mm);
  if (options.far_element_size_mm >= options.element_size_mm) return {};
  return fail(ErrorCode::kPlanInvalid,
              fmt::format("tissue.far_element_size_mm: {:g} is less than element_size_mm, {:g}",
                          options.far_element_size_mm, options.element_size_mm));
}

void read_boundary(const Json& boundary, predict::BoundaryOptions& options) {
  if (boundary.value("moved_bone", "contact") == "attached")
    options.moved_bone = predict::MovedBone::kAttached;
  if (boundary.value("scan_edge", "free") == "fixed") options.scan_edge = predict::ScanEdge::kFixed;
  read(boundary, "release_mm", options.release_mm);
  read(boundary, "capture_mm", options.capture_mm);
}

Result<PlanFile> read_sections(const Json& json, const fs::path& folder) {
  PlanFile plan;
  read(json, "title", plan.title);
  if (json.contains("ct")) plan.ct = folder / json["ct"].get<std::string>();

  const Json segmentation = section(json, "segmentation");
  read(segmentation, "bone_hu", plan.segmentation.bone_hu);
  read(segmentation, "skin_hu", plan.segmentation.skin_hu);
  if (segmentation.contains("labels"))
    plan.labels = folder / segmentation["labels"].get<std::string>();

  const Json& segment = json["segments"][0];
  LEFORT_TRY(plan.osteotomy, read_osteotomy(segment));
  read(segment["osteotomy"], "smallest_piece_ml", plan.cut.smallest_piece_ml);
  read(segment["osteotomy"], "smallest_piece_share", plan.cut.smallest_piece_share);
  plan.path = read_path(segment);
  LEFORT_TRY_VOID(plan::check_path(plan.path));

  LEFORT_TRY_VOID(read_tissue(section(json, "tissue"), plan.tissue));
  read_boundary(section(json, "boundary"), plan.boundary);

  const Json contact = section(json, "contact");
  read(contact, "stiffness_factor", plan.contact.stiffness_factor);
  if (contact.value("reconstruction", "smooth") == "trilinear")
    plan.contact.reconstruction = contact::Reconstruction::kTrilinear;

  const Json field = section(json, "field");
  read(field, "resolution", plan.field.resolution);
  read(field, "band_mm", plan.field.band_mm);
  read(field, "tolerance_mm", plan.field.tolerance_mm);

  const Json solver = section(json, "solver");
  read(solver, "relative_tolerance", plan.solver.relative_tolerance);
  read(solver, "max_iterations", plan.solver.max_iterations);
  read(solver, "smallest_step", plan.solver.smallest_step);
  return plan;
}

}  // namespace

Result<PlanFile> parse_plan(std::string_view text, const fs::path& folder) {
  LEFORT_TRY(const Json json, parse_json(text));
  LEFORT_TRY_VOID(check_against_schema(json));
  return read_sections(json, folder);
}

Result<PlanText> read_plan_text(const fs::path& file) {
  LEFORT_TRY(std::string text, read_text(file, kLargestPlan));
  std::error_code error;
  const fs::path absolute = fs::absolute(file, error);
  Result<PlanFile> plan = parse_plan(text, (error ? file : absolute).parent_path());
  if (!plan)
    return fail(plan.error().code, fmt::format("plan {}: {}", file.string(), plan.error().message));
  return PlanText{*std::move(plan), std::move(text)};
}

Result<PlanFile> read_plan(const fs::path& file) {
  LEFORT_TRY(PlanText text, read_plan_text(file));
  return std::move(text.plan);
}

}  // namespace lefort::io
