#include <lefort/io/read_text.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/validate/case_result.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kVersionOfFile = 1;

double number_of(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Json vector_json(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Vec3 vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

MethodStatistics statistics_of(const compare::RegionError& error) {
  const compare::DifferenceStatistics& s = error.statistics;
  return {s.mean_mm,
          s.median_mm,
          s.p90_mm,
          s.fraction_below_1mm,
          s.fraction_below_2mm,
          s.mean_signed_mm,
          error.mean_offset_mm.x(),
          error.mean_offset_mm.y(),
          error.mean_offset_mm.z()};
}

Json region_json(const RegionResult& region) {
  Json json{{"region", region.region},
            {"area_mm2", region.area_mm2},
            {"compared_fraction", region.compared_fraction},
            {"achieved_y_mm", finite_or_null(region.achieved_y_mm)},
            {"predicted_y_mm", finite_or_null(region.predicted_y_mm)}};
  for (std::size_t m = 0; m < kMethods.size(); ++m)
    for (std::size_t s = 0; s < kStatistics.size(); ++s)
      json[kMethods[m]][kStatistics[s]] = finite_or_null(region.methods[m][s]);
  return json;
}

RegionResult region_of(const Json& json) {
  RegionResult region;
  region.region = json.at("region").get<std::string>();
  region.area_mm2 = json.at("area_mm2").get<double>();
  region.compared_fraction = json.at("compared_fraction").get<double>();
  region.achieved_y_mm = number_of(json.at("achieved_y_mm"));
  region.predicted_y_mm = number_of(json.at("predicted_y_mm"));
  for (std::size_t m = 0; m < kMethods.size(); ++m)
    for (std::size_t s = 0; s < kStatistics.size(); ++s)
      region.methods[m][s] = number_of(json.at(kMethods[m]).at(kStatistics[s]));
  return region;
}

CaseResult result_of(const Json& json) {
  CaseResult result;
  result.name = json.at("case").get<std::string>();
  result.key = json.at("key").get<std::string>();
  if (!json.at("failure").is_null()) {
    result.failure = json.at("failure").get<std::string>();
    return result;
  }
  result.movement = json.at("movement").get<std::string>();
  result.regions_from = json.at("regions_from").get<std::string>();
  result.registered_on = json.at("registered_on").get<std::string>();
  for (const Json& one : json.at("segments"))
    result.segments.push_back(
        {one.at("segment").get<std::string>(), vector_of(one.at("translation_mm")),
         vector_of(one.at("rotation_deg")), one.at("max_displacement_mm").get<double>()});
  for (const Json& one : json.at("regions")) result.regions.push_back(region_of(one));
  for (const Json& one : json.at("pictures")) result.pictures.push_back(one.get<std::string>());
  return result;
}

}  // namespace

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

std::vector<RegionResult> region_results(
    const std::array<std::vector<compare::RegionError>, kMethods.size()>& errors) {
  std::vector<RegionResult> regions;
  for (std::size_t r = 0; r < errors[0].size(); ++r) {
    const compare::DifferenceStatistics& predicted = errors[0][r].statistics;
    if (predicted.area_mm2 == 0.0) continue;
    RegionResult region{.region = errors[0][r].region,
                        .area_mm2 = errors[1][r].statistics.area_mm2,
                        .compared_fraction = predicted.compared_fraction};
    for (std::size_t m = 0; m < kMethods.size(); ++m)
      region.methods[m] = statistics_of(errors[m][r]);
    regions.push_back(std::move(region));
  }
  return regions;
}

Json as_json(const CaseResult& result) {
  Json json{{"lefort_validation_case", kVersionOfFile},
            {"case", result.name},
            {"key", result.key},
            {"failure", result.failure ? Json(*result.failure) : Json()}};
  if (result.failure) return json;
  json["movement"] = result.movement;
  json["regions_from"] = result.regions_from;
  json["registered_on"] = result.registered_on;
  json["segments"] = Json::array();
  for (const SegmentMovement& one : result.segments)
    json["segments"].push_back({{"segment", one.segment},
                                {"translation_mm", vector_json(one.translation_mm)},
                                {"rotation_deg", vector_json(one.rotation_deg)},
                                {"max_displacement_mm", one.max_mm}});
  json["regions"] = Json::array();
  for (const RegionResult& region : result.regions) json["regions"].push_back(region_json(region));
  json["pictures"] = result.pictures;
  return json;
}

std::optional<CaseResult> case_result_of(const Json& json) {
  try {
    if (json.at("lefort_validation_case") == kVersionOfFile) return result_of(json);
  } catch (const nlohmann::json::exception&) {  // Not such a value.
  }
  return std::nullopt;
}

Result<CaseResult> read_case_result(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMaxBytes = 16 << 20;
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxBytes));
  if (auto result = case_result_of(Json::parse(text, nullptr, false))) return *std::move(result);
  return fail(ErrorCode::kFileCorrupt,
              fmt::format("{} is not the result of a case", file.filename().string()));
}

}  // namespace lefort::pipeline
