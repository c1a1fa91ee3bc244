/// \file
/// The result of one case of a cohort, as stored and as reported.
#pragma once

#include <lefort/compare/face_error.h>
#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// What is compared with the achieved face.
inline constexpr std::array kMethods{"prediction", "no_change", "ratio_rule"};

/// Statistics of one method in one region of a case. The first five are of the absolute distance.
/// mean_signed_mm is of the signed distance, positive outside the achieved face. The last three are
/// means of predicted minus achieved position along the axes of L.
inline constexpr std::array kStatistics{
    "mean_mm",        "median_mm", "p90_mm",    "fraction_below_1mm", "fraction_below_2mm",
    "mean_signed_mm", "mean_x_mm", "mean_y_mm", "mean_z_mm"};

/// In the order of kStatistics; NaN if nothing is compared.
using MethodStatistics = std::array<double, kStatistics.size()>;

struct RegionResult {
  std::string region;
  double area_mm2 = 0.0;           ///< Of the skin before surgery.
  double compared_fraction = 0.0;  ///< Of the area of the predicted skin.
  std::array<MethodStatistics, kMethods.size()> methods{};
  /// Mean displacement of the skin along y (posterior), from the face before surgery to the closest
  /// point of the achieved face, and to that of the predicted face.
  double achieved_y_mm = 0.0, predicted_y_mm = 0.0;
};

struct SegmentMovement {
  std::string segment;
  Vec3 translation_mm;  ///< Of the center of its bounding box.
  Vec3 rotation_deg;
  double max_mm = 0.0;  ///< Largest displacement of a point.
};

struct CaseResult {
  std::string name;
  std::string key;                       ///< Hash of all inputs and options.
  std::optional<std::string> failure{};  ///< Why there is no comparison.
  std::string movement{};                ///< "plan" or "achieved".
  std::string regions_from{};            ///< "landmarks" or "automatic".
  std::string registered_on{};           ///< "bone" or "none": the skin was in frame L.
  std::vector<SegmentMovement> segments{};
  std::vector<RegionResult> regions{};
  std::vector<std::string> pictures{};  ///< Names of files in pictures/.
};

/// \param errors  by kMethods, each in the order of compare::reported_regions().
/// \returns the regions with an area, without displacements.
[[nodiscard]] std::vector<RegionResult> region_results(
    const std::array<std::vector<compare::RegionError>, kMethods.size()>& errors);

/// The number, or null if it is not finite.
[[nodiscard]] nlohmann::ordered_json finite_or_null(double value);

/// Values that are not finite become null.
[[nodiscard]] nlohmann::ordered_json as_json(const CaseResult& result);

/// \returns the result, or nothing if the value is not one of as_json().
[[nodiscard]] std::optional<CaseResult> case_result_of(const nlohmann::ordered_json& json);

/// \returns the result; kFileNotFound; or kFileCorrupt if the file is not one of as_json().
[[nodiscard]] Result<CaseResult> read_case_result(const std::filesystem::path& file);

}  // namespace lefort::pipeline
