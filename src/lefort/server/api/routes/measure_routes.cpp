#include <lefort/io/landmarks_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/server/api/contract.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/measure_stages.h>
#include <lefort/server/case/served_case.h>
#include <lefort/server/case/tooth_numbers.h>

#include <fmt/format.h>

#include <initializer_list>
#include <span>
#include <string>
#include <system_error>
#include <utility>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

using Keys = std::initializer_list<const char*>;

/// The keys of an object that a page shows.
json only(const json& object, Keys keys) {
  json shown = json::object();
  for (const char* key : keys)
    if (object.is_object())
      if (const auto found = object.find(key); found != object.end()) shown[key] = *found;
  return shown;
}

/// Replaces each member that is there by its shown keys.
void only_within(json& object, Keys members, Keys keys) {
  for (const char* name : members)
    if (object.contains(name)) object[name] = only(object[name], keys);
}

/// The document of a stage.
struct Document {
  const char* stage;
  const char* schema;
  json (*shown)(const ServedCase& served, const json& document);
};

Response document_reply(ServedCase& served, const Request& request, const Document& document) {
  const fs::path file = document_of_measure(served.folder, document.stage);
  const auto etag = served.folder.etag(file);
  if (!etag) return not_found("this is not computed yet");
  if (is_not_modified(request, etag)) return not_modified(etag);
  // Any program may have written the file.
  std::string text = document.shown(served, read_object(file))
                         .dump(-1, ' ', false, json::error_handler_t::replace);
  if (const auto valid = parse_by_contract(text, document.schema); !valid)
    return error_response(422, "invalid",
                          fmt::format("{} is damaged, or of another version: compute it again",
                                      file.filename().string()));
  Response reply;
  reply.text = std::move(text);
  return with_etag(std::move(reply), etag);
}

/// The corrections with which teeth.json was computed.
json applied_corrections(const ServedCase& served) {
  return read_object(served.folder.teeth() / "teeth_corrections.json");
}

Response get_teeth(ServedCase& served, const Request& request, const PathValues&) {
  return document_reply(served, request,
                        {"teeth", "Teeth", [](const ServedCase& of, const json& document) {
                           json shown = only(with_found_numbers(document, applied_corrections(of)),
                                             {"notice", "teeth", "missing"});
                           if (shown.contains("teeth") && shown["teeth"].is_array())
                             for (json& tooth : shown["teeth"])
                               tooth = only(tooth, {"fdi", "found", "crown", "apex", "length_mm",
                                                    "width_mm", "volume_mm3"});
                           return shown;
                         }});
}

Response get_arches(ServedCase& served, const Request& request, const PathValues&) {
  return document_reply(
      served, request,
      {"arches", "Arches", [](const ServedCase&, const json& document) {
         json shown = only(document, {"notice", "upper", "lower"});
         only_within(shown, {"upper", "lower"}, {"scale", "is_reversed", "distances", "sextants"});
         return shown;
       }});
}

Response get_occlusion(ServedCase& served, const Request& request, const PathValues&) {
  return document_reply(
      served, request,
      {"occlusion", "Occlusion", [](const ServedCase&, const json& document) {
         json shown = only(document, {"notice", "source", "bites", "movement", "contacts",
                                      "overjet_mm", "overbite_mm", "relations", "requests"});
         only_within(shown, {"relations"},
                     {"midline_mm", "right_canine", "left_canine", "right_molar", "left_molar"});
         only_within(shown, {"requests"}, {"midline_mm", "overjet_mm", "overbite_mm"});
         if (const auto pose = document.find("pose_4x4_row_major_mm_lps"); pose != document.end())
           shown["pose"] = *pose;
         return shown;
       }});
}

json shown_splint(const ServedCase&, const json& document) {
  json shown = only(document, {"notice", "volume_ml", "parts", "min_thickness_mm", "open_mm",
                               "text", "upper", "lower"});
  only_within(shown, {"upper", "lower"}, {"clearance_mm", "max_penetration_mm"});
  for (const char* jaw : {"upper", "lower"})
    if (const auto pose = document.find(fmt::format("{}_pose_4x4_row_major_mm_lps", jaw));
        pose != document.end())
      shown[fmt::format("{}_pose", jaw)] = *pose;
  return shown;
}

Response get_splint(ServedCase& served, const Request& request, const PathValues& values) {
  if (values[0] == "final")
    return document_reply(served, request, {"splint_final", "Splint", shown_splint});
  if (values[0] == "intermediate")
    return document_reply(served, request, {"splint_intermediate", "Splint", shown_splint});
  return not_found("no such splint");
}

json as_points_json(const plan::Landmarks& landmarks) {
  json points = json::object();
  for (const plan::Landmark& one : landmarks)
    points[one.name] = {one.point_L.x(), one.point_L.y(), one.point_L.z()};
  return points;
}

Response get_nerve(ServedCase& served, const Request& request, const PathValues&) {
  return document_reply(
      served, request,
      {"nerve", "Nerve", [](const ServedCase& of, const json& document) {
         json shown = only(document, {"notice", "right", "left"});
         only_within(shown, {"right", "left"}, {"length_mm", "visible_fraction", "points"});
         const auto points = io::read_landmarks(of.folder.nerve() / "nerve.mrk.json");
         if (points) shown["points"] = as_points_json(*points);
         return shown;
       }});
}

json shown_guides(const ServedCase&, const json& document) {
  json shown = only(document, {"notice", "hole_diameter_mm", "min_distance_mm",
                               "are_nerves_considered", "are_roots_considered", "guides"});
  if (!shown.contains("guides") || !shown["guides"].is_array()) return shown;
  for (json& guide : shown["guides"]) {
    guide = only(guide, {"name", "segment", "put_on_from", "volume_ml", "parts", "slot_mm",
                         "slot_width_mm", "fit", "holes"});
    only_within(guide, {"fit"}, {"clearance_mm", "max_penetration_mm"});
    if (guide.contains("holes") && guide["holes"].is_array())
      for (json& hole : guide["holes"]) {
        hole = only(hole, {"name", "bone", "before_mm", "after_mm", "bone_mm", "closest"});
        only_within(hole, {"closest"}, {"name", "distance_mm"});
      }
  }
  return shown;
}

Response get_guides(ServedCase& served, const Request& request, const PathValues&) {
  return document_reply(served, request, {"guides", "Guides", shown_guides});
}

/// Of the airway.
void only_sections(json& shown) {
  only_within(shown, {"min_section", "min_axial_section"},
              {"area_mm2", "width_mm", "depth_mm", "along_mm"});
}

Response get_airway(ServedCase& served, const Request& request, const PathValues&) {
  return document_reply(
      served, request, {"airway", "Airway", [](const ServedCase&, const json& document) {
                          json shown =
                              only(document,
                                   {"notice", "upper", "lower", "front", "has_frankfurt_horizontal",
                                    "volume_ml", "length_mm", "closed_mm", "below_upper_mm",
                                    "above_lower_mm", "min_section", "min_axial_section", "after"});
                          only_sections(shown);
                          only_within(shown, {"after"},
                                      {"volume_ml", "length_mm", "closed_mm", "min_section",
                                       "min_axial_section", "wall_in_tissue_mesh"});
                          if (shown.contains("after")) only_sections(shown["after"]);
                          return shown;
                        }});
}

Response get_cephalogram(ServedCase& served, const Request& request, const PathValues&) {
  return document_reply(
      served, request,
      {"cephalogram", "Cephalogram", [](const ServedCase&, const json& document) {
         return only(document, {"notice", "has_frankfurt_horizontal", "measurements"});
       }});
}

// Corrections

Response get_tooth_corrections(ServedCase& served, const Request& request, const PathValues&) {
  const auto file = tooth_corrections(served.folder);
  if (!file)
    return json_response({{"lefort_tooth_corrections", 1}, {"corrections", json::array()}});
  const auto etag = served.folder.etag(*file);
  if (is_not_modified(request, etag)) return not_modified(etag);
  std::string text = read_object(*file).dump(-1, ' ', false, json::error_handler_t::replace);
  if (const auto valid = parse_by_contract(text, "ToothCorrections"); !valid)
    return error_response(422, "invalid", "teeth_corrections.json is damaged: correct them again");
  Response reply;
  reply.text = std::move(text);
  return with_etag(std::move(reply), etag);
}

Response put_tooth_corrections(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "ToothCorrections");
  if (!body.value) return body.error;
  const std::scoped_lock lock(served.writing);
  const fs::path file = served.folder.tooth_corrections();
  if (auto refused = check_precondition(request, served.folder.etag(file))) return *refused;
  const json& corrections = (*body.value)["corrections"];
  const json teeth = with_found_numbers(read_object(document_of_measure(served.folder, "teeth")),
                                        applied_corrections(served));
  if (const auto valid = check_tooth_corrections(corrections, teeth); !valid)
    return error_response(valid.error(), "corrections");
  if (corrections.empty()) {
    std::error_code error;
    fs::remove(file, error);
  } else {
    if (const auto written = io::write_text(file, body.value->dump(1) + "\n"); !written)
      return error_response(written.error());
    if (const auto recorded = served.folder.record_scan(kToothCorrections); !recorded)
      return error_response(recorded.error());
  }
  served.report_stages();
  return with_etag(json_response(*body.value), served.folder.etag(file));
}

Response get_nerve_points(ServedCase& served, const Request& request, const PathValues&) {
  const auto file = nerve_points(served.folder);
  if (!file) return json_response({{"points", json::object()}});
  const auto etag = served.folder.etag(*file);
  if (is_not_modified(request, etag)) return not_modified(etag);
  const auto points = io::read_landmarks(*file);
  if (!points) return error_response(points.error());
  const json shown{{"points", as_points_json(*points)}};
  if (const auto valid = parse_by_contract(shown.dump(), "NervePoints"); !valid)
    return error_response(422, "invalid", "nerve_points.mrk.json is damaged: correct them again");
  return with_etag(json_response(shown), etag);
}

Response put_nerve_points(ServedCase& served, const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "NervePoints");
  if (!body.value) return body.error;
  plan::Landmarks points;
  for (const auto& [name, point] : (*body.value)["points"].items())
    points.push_back({name, Vec3(point[0], point[1], point[2])});
  const std::scoped_lock lock(served.writing);
  const fs::path file = served.folder.nerve_points();
  if (auto refused = check_precondition(request, served.folder.etag(file))) return *refused;
  if (points.empty()) {
    std::error_code error;
    fs::remove(file, error);
  } else {
    if (const auto written = io::write_landmarks(file, points); !written)
      return error_response(written.error());
    if (const auto recorded = served.folder.record_scan(kNervePoints); !recorded)
      return error_response(recorded.error());
  }
  served.report_stages();
  return with_etag(json_response(*body.value), served.folder.etag(file));
}

}  // namespace

std::span<const Route> measure_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/teeth", get_teeth},
                                      {"GET", "/teeth/corrections", get_tooth_corrections},
                                      {"PUT", "/teeth/corrections", put_tooth_corrections},
                                      {"GET", "/arches", get_arches},
                                      {"GET", "/occlusion", get_occlusion},
                                      {"GET", "/splints/{splint}", get_splint},
                                      {"GET", "/nerve", get_nerve},
                                      {"GET", "/nerve/points", get_nerve_points},
                                      {"PUT", "/nerve/points", put_nerve_points},
                                      {"GET", "/guides", get_guides},
                                      {"GET", "/airway", get_airway},
                                      {"GET", "/cephalogram", get_cephalogram}};
  return kRoutes;
}

}  // namespace lefort::server
