#include <lefort/io/plan_file.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/predict/interface_map.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/served_case.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using predict::BoundaryLabel;
using predict::BoundaryLabelMap;

constexpr std::uint64_t kMaxFile = 256 << 20;  // Bytes of a compressed file, as in the contract.

/// Box of voxels of the scan, from `first`.
struct Box {
  std::array<Index, 3> first{}, size{};

  [[nodiscard]] std::uint64_t voxels() const { return std::uint64_t(size[0] * size[1] * size[2]); }
  [[nodiscard]] std::string text() const {
    return fmt::format("{},{},{},{},{},{}", first[0], first[1], first[2], size[0], size[1],
                       size[2]);
  }
  /// The grid of the box.
  [[nodiscard]] image::Grid of(image::Grid grid) const {
    grid.origin_L = grid.point_L(Vec3(double(first[0]), double(first[1]), double(first[2])));
    grid.size = size;
    return grid;
  }
};

/// The box in a query, if it lies within the scan.
std::optional<Box> box_of(const Request& request, const image::Grid& grid) {
  const auto found = request.query.find("box");
  if (found == request.query.end()) return std::nullopt;
  std::array<Index, 6> numbers{};
  const char* at = found->second.data();
  const char* const end = at + found->second.size();
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    if (n > 0 && (at == end || *at++ != ',')) return std::nullopt;
    const auto [rest, error] = std::from_chars(at, end, numbers[n]);
    if (error != std::errc()) return std::nullopt;
    at = rest;
  }
  if (at != end) return std::nullopt;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Index first = numbers[axis], size = numbers[axis + 3], all = grid.size[axis];
    if (first < 0 || first >= all || size < 1 || size > all - first) return std::nullopt;
  }
  return Box{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
}

/// The bounding box of the painted voxels. \pre some are painted.
Box painted_box(const BoundaryLabelMap& painted) {
  std::array<Index, 3> first = painted.grid.size, last{};
  for (Index k = 0; k < painted.grid.size[2]; ++k)
    for (Index j = 0; j < painted.grid.size[1]; ++j)
      for (Index i = 0; i < painted.grid.size[0]; ++i) {
        if (painted.at(i, j, k) == BoundaryLabel::kNone) continue;
        const std::array<Index, 3> at{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          first[axis] = std::min(first[axis], at[axis]);
          last[axis] = std::max(last[axis], at[axis]);
        }
      }
  return {first, {last[0] - first[0] + 1, last[1] - first[1] + 1, last[2] - first[2] + 1}};
}

/// Only the painted box, so that equal paint gives equal files.
BoundaryLabelMap cropped(const BoundaryLabelMap& painted) {
  const Box box = painted_box(painted);
  BoundaryLabelMap part{box.of(painted.grid), {}};
  part.values.reserve(box.voxels());
  for (Index k = 0; k < box.size[2]; ++k)
    for (Index j = 0; j < box.size[1]; ++j)
      for (Index i = 0; i < box.size[0]; ++i)
        part.values.push_back(painted.at(i + box.first[0], j + box.first[1], k + box.first[2]));
  return part;
}

json paintable_labels() {
  json names = json::array();
  for (const predict::BoundaryLabelStyle& style : predict::kBoundaryLabelStyles)
    names.push_back({{"value", int(style.label)}, {"name", style.name}, {"color", style.color}});
  return names;
}

/// Color of a condition: that of the label of its name. Plane ends of the mesh have no label.
std::array<double, 3> color_of(const predict::InterfaceConditionStyle& condition) {
  for (const predict::BoundaryLabelStyle& style : predict::kBoundaryLabelStyles)
    if (std::string_view(style.name) == condition.name) return style.color;
  const bool is_roller = condition.condition == predict::InterfaceCondition::kRoller;
  return is_roller ? std::array{0.45, 0.45, 0.45} : std::array{0.80, 0.47, 0.65};
}

json conditions_json() {
  json conditions = json::array();
  for (const predict::InterfaceConditionStyle& style : predict::kInterfaceConditions)
    conditions.push_back(
        {{"value", int(style.condition)}, {"name", style.name}, {"color", color_of(style)}});
  return conditions;
}

json rules_json() {
  json rules = json::array();
  for (const predict::InterfaceRuleStyle& style : predict::kInterfaceRules)
    rules.push_back({{"value", int(style.rule)}, {"name", style.name}});
  return rules;
}

/// Groups of a result's interface map; segments by name.
json groups_json(const json& interface, const io::PlanFile& plan) {
  json groups = json::array();
  for (json group : interface.at("groups")) {
    if (const json& segment = group.at("segment"); !segment.is_null())
      group["segment"] = plan.segments.at(segment.get<std::size_t>()).osteotomy.segment;
    groups.push_back(std::move(group));
  }
  return groups;
}

/// Interface map and painted areas of the tissue mesh of this plan; null if there is none.
json map_json(const CaseFolder& folder, const io::PlanFile& plan) {
  const auto stage = fresh_tissue_stage(folder);
  if (!stage) return nullptr;
  const json document = *stage == "preview" ? read_object(folder.preview() / "preview.json")
                                            : read_object(folder.prediction() / "prediction.json");
  try {
    const json& boundary =
        *stage == "preview" ? document.at("boundary") : document.at("mesh").at("boundary");
    json painted = json::array();
    if (boundary.at("painted").is_object())
      for (const auto& [name, mm2] : boundary["painted"].at("area_mm2").items())
        painted.push_back({{"name", name}, {"area_mm2", mm2}});
    return {{"stage", *stage},
            {"groups", groups_json(boundary.at("interface"), plan)},
            {"painted", painted}};
  } catch (const json::exception&) {  // Written by an older version: ignored.
  } catch (const std::out_of_range&) {
  }
  return nullptr;
}

Response get_boundary(ServedCase& served, const Request&, const PathValues&) {
  const auto plan = io::read_plan(served.folder.plan());
  const predict::BoundaryOptions options = plan ? plan->boundary : predict::BoundaryOptions{};
  return json_response({{"names", paintable_labels()},
                        {"contact_snap_mm", options.contact_snap_mm},
                        {"conditions", conditions_json()},
                        {"rules", rules_json()},
                        {"map", plan ? map_json(served.folder, *plan) : json()}});
}

Response get_boundary_data(ServedCase& served, const Request& request, const PathValues&) {
  const auto etag = served.folder.etag(served.folder.boundary());
  if (!etag) return not_found("no boundary conditions are painted");
  if (is_not_modified(request, etag)) return not_modified(etag);
  const auto ct = served.volume();
  if (!ct) return error_response(ct.error());
  const auto painted = io::read_boundary_labels(served.folder.boundary(), (*ct)->grid);
  if (!painted) return error_response(painted.error());
  const auto part = std::make_shared<const BoundaryLabelMap>(cropped(*painted));
  Response reply = binary_response(
      {part, {reinterpret_cast<const char*>(part->values.data()), part->values.size()}});
  reply.headers.emplace_back("X-Lefort-Box", painted_box(*painted).text());
  return with_etag(std::move(reply), etag);
}

/// Stores painted boundary conditions if If-Match names the present version.
///
/// \param ct_etag  of the scan on which it was painted.
Response keep(ServedCase& served, const Request& request, const BoundaryLabelMap& painted,
              const std::optional<std::string>& ct_etag) {
  const bool is_painted =
      std::any_of(painted.values.begin(), painted.values.end(),
                  [](BoundaryLabel label) { return label != BoundaryLabel::kNone; });
  if (!is_painted)
    return error_response(422, "invalid", "no voxel is painted: use DELETE to remove the paint");
  const std::scoped_lock lock(served.writing);
  if (served.folder.etag(served.folder.ct()) != ct_etag)
    return error_response(409, "stale", "the scan was replaced meanwhile: reload it");
  if (auto refused = check_precondition(request, served.folder.etag(served.folder.boundary())))
    return *refused;
  if (const auto written = io::write_boundary_labels(served.folder.boundary(), cropped(painted));
      !written)
    return error_response(written.error());
  if (const auto recorded = served.folder.record_scan("boundary"); !recorded)
    return error_response(recorded.error());
  served.report_stages();
  return with_etag(empty_reply(), served.folder.etag(served.folder.boundary()));
}

Response put_boundary_data(ServedCase& served, const Request& request, const PathValues&) {
  const auto ct_etag = served.folder.etag(served.folder.ct());
  const auto ct = served.volume();
  if (!ct) return error_response(ct.error());
  const auto box = box_of(request, (*ct)->grid);
  if (!box)
    return error_response(
        422, "invalid",
        "box must be six integers, the first voxel and the number along each axis, "
        "within the scan",
        "box");
  Body body = read_body(request, box->voxels(), "application/octet-stream");
  if (!body.text) return body.error;
  if (body.text->size() != box->voxels())
    return error_response(
        422, "invalid",
        fmt::format("the body must have {} bytes, one per voxel of the box, it has {}",
                    box->voxels(), body.text->size()));
  BoundaryLabelMap painted{box->of((*ct)->grid), {}};
  painted.values.reserve(body.text->size());
  for (const char c : *body.text) {
    if (static_cast<unsigned char>(c) > predict::kBoundaryLabelStyles.size())
      return error_response(422, "invalid", fmt::format("label {} is none", int(std::uint8_t(c))));
    painted.values.push_back(BoundaryLabel(c));
  }
  return keep(served, request, painted, ct_etag);
}

/// Boundary conditions painted in another program.
Response put_boundary_file(ServedCase& served, const Request& request, const PathValues&) {
  const auto ct_etag = served.folder.etag(served.folder.ct());
  const auto ct = served.volume();
  if (!ct) return error_response(ct.error());
  Body body = read_body(request, kMaxFile, "application/octet-stream");
  if (!body.text) return body.error;
  std::error_code error;
  fs::create_directories(served.folder.uploads(), error);
  const fs::path file =
      served.folder.uploads() / fmt::format("painted-{}.seg.nrrd", random_hex(16));
  if (const auto written = io::write_text(file, *body.text); !written)
    return error_response(written.error());
  const auto painted = io::read_boundary_labels(file, (*ct)->grid);
  fs::remove(file, error);
  if (!painted) return error_response(422, "invalid", painted.error().message);
  return keep(served, request, *painted, ct_etag);
}

Response delete_boundary_data(ServedCase& served, const Request& request, const PathValues&) {
  const std::scoped_lock lock(served.writing);
  const auto etag = served.folder.etag(served.folder.boundary());
  if (!etag) return not_found("no boundary conditions are painted");
  if (auto refused = check_precondition(request, etag)) return *refused;
  if (names_boundary(read_object(served.folder.plan())))
    return error_response(
        409, "not_allowed",
        "the plan uses the painted boundary conditions: remove boundary.labels first");
  std::error_code error;
  fs::remove(served.folder.boundary(), error);
  if (error)
    return error_response(500, "internal", "the painted boundary conditions cannot be removed");
  served.report_stages();
  return empty_reply();
}

}  // namespace

std::span<const Route> boundary_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/boundary", get_boundary},
                                      {"GET", "/boundary/data", get_boundary_data},
                                      {"PUT", "/boundary/data", put_boundary_data},
                                      {"DELETE", "/boundary/data", delete_boundary_data},
                                      {"PUT", "/boundary/file", put_boundary_file}};
  return kRoutes;
}

}  // namespace lefort::server
