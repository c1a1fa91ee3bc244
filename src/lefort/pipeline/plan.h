/// \file
/// Landmarks, the check of a plan, its cut bones and the preview of its face.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>
#include <lefort/predict/check_plan.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

struct LandmarksJob {
  std::filesystem::path before;                 ///< .mrk.json or .csv; empty with `find`.
  std::optional<std::filesystem::path> find;    ///< A scan in which the landmarks are found.
  std::optional<std::filesystem::path> labels;  ///< Of that scan; segmented unless given.
  std::optional<std::filesystem::path> after;   ///< As `before`.
  std::optional<std::filesystem::path> output;  ///< .csv.
  std::optional<std::filesystem::path> save;    ///< .mrk.json or .csv.
};

/// Measures angles and distances between landmarks that are read, or found in a scan.
[[nodiscard]] Result<Summary> measure_landmarks(const LandmarksJob& job, Progress& progress);

struct CheckPlanJob {
  std::filesystem::path plan;
  std::optional<std::filesystem::path> ct;     ///< Instead of the plan's.
  std::optional<std::filesystem::path> skull;  ///< A closed surface, instead of any scan.
  std::filesystem::path output;                ///< A folder; made if missing.
  std::optional<std::filesystem::path> cache;  ///< A folder; cache/ of the output unless given.
  predict::PlanLimits limits;
  bool pictures = true;
};
struct PlanCheckSummary {
  Summary summary;
  bool has_findings = false;  ///< Overlap, gap or missing support beyond the limits.
};
/// Computes the segments at the end of their paths, and the findings of the check.
[[nodiscard]] Result<PlanCheckSummary> check_plan_file(const CheckPlanJob& job, Progress& progress);

struct CutJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path cache;   ///< Folder of cached stages.
  std::filesystem::path output;  ///< A folder; made if missing.
};

/// Writes the bones of a plan before they move, with distance fields, so that a page can move them.
/// cut.json, which is written last, names the files.
[[nodiscard]] Result<Summary> cut_plan(const CutJob& job, Progress& progress);

struct PreviewJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path cache;   ///< As of CutJob.
  std::filesystem::path skin;    ///< Skin of segment_scan(), to be displaced.
  std::filesystem::path output;  ///< A folder; made if missing.
};

/// Computes the linear response of the face to the motion of the segments. preview.json is written
/// last.
[[nodiscard]] Result<Summary> prepare_preview(const PreviewJob& job, Progress& progress);

}  // namespace lefort::pipeline
