/// \file
/// Measures of the airway in a scan.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>
#include <string>

namespace lefort::pipeline {

struct AirwayJob {
  std::filesystem::path ct;                        ///< Anything `lefort import` reads.
  std::optional<std::filesystem::path> labels;     ///< .seg.nrrd; segmented unless given.
  std::optional<std::filesystem::path> landmarks;  ///< What is missing is found.
  std::string upper = "PNS";                       ///< A landmark or x,y,z on the upper plane.
  std::string lower = "Me";                        ///< The same of the lower plane.
  std::string front = "PNS";                       ///< The same of the coronal plane in front.
  /// Folder of a prediction: the airway is also measured after its movement.
  std::optional<std::filesystem::path> prediction;
  std::filesystem::path output;  ///< A folder; made if missing.
};

/// Measures the airway (anatomy::measure_airway()). Upper and lower plane are parallel to the
/// Frankfurt horizontal. Writes `airway.vtp` (surface), `airway.csv` (sections along the center
/// line), `airway.svg` (their areas) and `airway.json`.
///
/// With a prediction the scan is warped by the displacements of its soft tissue and bones
/// (anatomy::warped()), and measured again between the moved limits: `airway_after.vtp`, `.csv` and
/// `.svg`. The summary states how much of the wall lies in the tissue mesh of the prediction.
///
/// \returns the summary, or
///   - the errors of oriented_head() and anatomy::measure_airway();
///   - kInvalidArgument  a plane is neither a landmark of this head nor a point;
///   - kInvalidArgument  the prediction is of another scan; or the errors of predicted_movement();
///   - kFileUnwritable   a result cannot be written.
[[nodiscard]] Result<Summary> measure_airway_of_scan(const AirwayJob& job, Progress& progress);

}  // namespace lefort::pipeline
