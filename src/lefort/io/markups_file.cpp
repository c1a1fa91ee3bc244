#include <lefort/io/internal/checked_json.h>
#include <lefort/io/markups_file.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <optional>

namespace lefort::io {
namespace {

using internal::Json;

constexpr std::uintmax_t kLargestMarkups = 64 << 20;  // Bytes.

/// What we need of Slicer's markups-schema-v1.0.3.json, which allows more.
constexpr const char* kSchema = R"({
  "type": "object", "required": ["markups"],
  "properties": {"markups": {"type": "array", "items": {
    "type": "object", "required": ["type"],
    "properties": {
      "type": {"type": "string"},
      "name": {"type": "string"},
      "coordinateSystem": {"enum": ["LPS", "RAS"]},
      "controlPoints": {"type": "array", "items": {
        "type": "object",
        "properties": {
          "label": {"type": "string"},
          "position": {"type": "array", "minItems": 3, "maxItems": 3,
                       "items": {"type": "number", "minimum": -1e8, "maximum": 1e8}},
          "positionStatus": {"type": "string"}
        }
      }}
    }
  }}}
})";
constexpr const char* kWrittenSchema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/"
    "Schema/markups-schema-v1.0.3.json#";

/// Millimetres of a unit; nothing if it is none we know. Slicer writes "mm", or a DICOM code.
std::optional<double> mm_of(const Json& markup) {
  const auto found = markup.find("coordinateUnits");
  if (found == markup.end()) return 1.0;
  const Json& unit = found->is_array() && !found->empty() ? found->front() : *found;
  if (unit == "mm") return 1.0;
  if (unit == "um") return 1e-3;
  return std::nullopt;
}

bool is_placed(const Json& point) {
  return point.contains("position") && point.value("positionStatus", "defined") == "defined";
}

Result<Markup> read_markup(const Json& json, std::size_t number) {
  Markup markup;
  markup.type = json["type"].get<std::string>();
  internal::read(json, "name", markup.name);
  const std::optional<double> mm = mm_of(json);
  if (!mm)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("markups[{}].coordinateUnits: must be mm or um", number));
  const bool is_ras = json.value("coordinateSystem", "LPS") == "RAS";
  for (const Json& point : internal::list(json, "controlPoints")) {
    if (!is_placed(point)) continue;
    Vec3 p = *mm * internal::as_vector(point["position"]);
    if (is_ras) p = Vec3(-p.x(), -p.y(), p.z());
    markup.points.push_back({point.value("label", std::string()), p});
  }
  return markup;
}

}  // namespace

Result<std::vector<Markup>> parse_markups(std::string_view text) {
  const Result<Json> json = internal::parse_checked(text, kSchema, "the markups file");
  if (!json) return fail(ErrorCode::kFileCorrupt, json.error().message);
  std::vector<Markup> markups;
  for (const Json& one : (*json)["markups"]) {
    LEFORT_TRY(Markup markup, read_markup(one, markups.size()));
    markups.push_back(std::move(markup));
  }
  return markups;
}

Result<std::vector<Markup>> read_markups(const std::filesystem::path& file) {
  LEFORT_TRY(const std::string text, read_text(file, kLargestMarkups));
  Result<std::vector<Markup>> markups = parse_markups(text);
  if (!markups)
    return fail(markups.error().code,
                fmt::format("markups {}: {}", file.string(), markups.error().message));
  return markups;
}

Result<void> write_point_list(const std::filesystem::path& file, const std::string& name,
                              std::span<const plan::Landmark> points_L) {
  using Ordered = nlohmann::ordered_json;
  Ordered points = Ordered::array();
  for (const auto& [label, p_L] : points_L)
    points.push_back({{"id", std::to_string(points.size() + 1)},
                      {"label", label},
                      {"description", plan::full_name(label)},
                      {"associatedNodeID", ""},
                      {"position", {p_L.x(), p_L.y(), p_L.z()}},
                      {"orientation", {-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0}},
                      {"selected", true},
                      {"locked", false},
                      {"visibility", true},
                      {"positionStatus", "defined"}});
  const Ordered whole{{"@schema", kWrittenSchema},
                      {"markups",
                       {{{"type", "Fiducial"},
                         {"name", name},
                         {"coordinateSystem", "LPS"},
                         {"coordinateUnits", "mm"},
                         {"locked", false},
                         {"fixedNumberOfControlPoints", false},
                         {"labelFormat", "%N-%d"},
                         {"lastUsedControlPointNumber", points_L.size()},
                         {"controlPoints", points},
                         {"measurements", Ordered::array()}}}}};
  return write_text(file, whole.dump(2, ' ', false, Ordered::error_handler_t::replace) + "\n");
}

}  // namespace lefort::io
