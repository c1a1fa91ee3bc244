#include <lefort/core/check.h>
#include <lefort/io/internal/validated_json.h>
#include <lefort/io/markups_file.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace lefort::io {
namespace {

using internal::Json;

constexpr std::uintmax_t kMaxMarkups = 64 << 20;  // Bytes.

/// The required part of Slicer's markups-schema-v1.0.3.json.
constexpr const char* kSchema = R"({
  "type": "object", "required": ["markups"],
  "properties": {"markups": {"type": "array", "items": {
    "type": "object", "required": ["type"],
    "properties": {
      "type": {"type": "string"},
      "name": {"type": "string"},
      "coordinateSystem": {"enum": ["LPS", "RAS"]},
      "center": {"$ref": "#/definitions/vector"},
      "normal": {"$ref": "#/definitions/vector"},
      "orientation": {"type": "array", "minItems": 9, "maxItems": 9,
                      "items": {"type": "number", "minimum": -1e8, "maximum": 1e8}},
      "size": {"$ref": "#/definitions/vector"},
      "controlPoints": {"type": "array", "items": {
        "type": "object",
        "properties": {
          "label": {"type": "string"},
          "position": {"$ref": "#/definitions/vector"},
          "positionStatus": {"type": "string"}
        }
      }}
    }
  }}},
  "definitions": {"vector": {"type": "array", "minItems": 3, "maxItems": 3,
                             "items": {"type": "number", "minimum": -1e8, "maximum": 1e8}}}
})";
constexpr const char* kWrittenSchema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/"
    "Schema/markups-schema-v1.0.3.json#";

/// Returns the unit in mm; nothing if it is unknown. Slicer writes "mm" or a DICOM code.
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

Vec3 in_L(const Vec3& v, bool is_ras) { return is_ras ? Vec3(-v.x(), -v.y(), v.z()) : v; }

/// Nothing for planes of Slicer before version 5, which are defined by three points only.
Result<std::optional<MarkupPlane>> read_plane(const Json& json, double mm, bool is_ras,
                                              std::size_t number) {
  if (!json.contains("center") || !json.contains("normal")) return std::nullopt;
  MarkupPlane plane{mm * in_L(internal::as_vector(json["center"]), is_ras),
                    in_L(internal::as_vector(json["normal"]), is_ras), Vec3::Zero()};
  if (!(plane.normal_L.norm() > 1e-9))
    return fail(ErrorCode::kFileCorrupt, fmt::format("markups[{}].normal: it is zero", number));
  plane.normal_L.normalize();
  // The first column is the direction of the width; the default is any direction in the plane.
  if (const auto& axes = internal::list(json, "orientation"); axes.size() == 9)
    plane.across_L =
        in_L({axes[0].get<double>(), axes[3].get<double>(), axes[6].get<double>()}, is_ras);
  plane.across_L -= plane.across_L.dot(plane.normal_L) * plane.normal_L;
  if (!(plane.across_L.norm() > 1e-9)) plane.across_L = plane.normal_L.unitOrthogonal();
  plane.across_L.normalize();
  if (const auto& size = internal::list(json, "size"); size.size() == 3) {
    plane.width_mm = mm * std::abs(size[0].get<double>());
    plane.height_mm = mm * std::abs(size[1].get<double>());
  }
  return plane;
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
    markup.points.push_back({point.value("label", std::string()),
                             *mm * in_L(internal::as_vector(point["position"]), is_ras)});
  }
  if (markup.type == "Plane") {
    LEFORT_TRY(markup.plane, read_plane(json, *mm, is_ras, number));
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
  LEFORT_TRY(const std::string text, read_text(file, kMaxMarkups));
  Result<std::vector<Markup>> markups = parse_markups(text);
  if (!markups)
    return fail(markups.error().code,
                fmt::format("markups {}: {}", file.string(), markups.error().message));
  return markups;
}

Result<void> write_point_list(const std::filesystem::path& file, const std::string& name,
                              std::span<const plan::Landmark> points_L,
                              std::span<const std::string> remarks) {
  using Ordered = nlohmann::ordered_json;
  LEFORT_CHECK(remarks.empty() || remarks.size() == points_L.size());
  Ordered points = Ordered::array();
  for (const auto& [label, p_L] : points_L)
    points.push_back({{"id", std::to_string(points.size() + 1)},
                      {"label", label},
                      {"description", plan::full_name(label) +
                                          (remarks.empty() ? "" : "; " + remarks[points.size()])},
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
