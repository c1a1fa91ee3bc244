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
  std::filesystem::path before;                 ///< .mrk.json or .csv.
  std::optional<std::filesystem::path> after;   ///< Likewise.
  std::optional<std::filesystem::path> output;  ///< .csv.
  std::optional<std::filesystem::path> save;    ///< .mrk.json or .csv.
};
/// Landmarks -> angles and distances between them.
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
  bool has_findings = false;  ///< Something was found against the plan.
};
/// Plan -> cut bones where they end, and what keeps them from going there.
[[nodiscard]] Result<PlanCheckSummary> check_plan_file(const CheckPlanJob& job, Progress& progress);

struct CutJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path cache;   ///< A folder that keeps what stages share.
  std::filesystem::path output;  ///< A folder; made if missing.
};
/// Plan -> its bones where they are before they move, and their distance fields: what a page needs
/// to move them. cut.json, which is written last, names the files.
[[nodiscard]] Result<Summary> cut_plan(const CutJob& job, Progress& progress);

struct PreviewJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path cache;   ///< As of CutJob.
  std::filesystem::path skin;    ///< The surface whose displacement is wanted: segment_scan()'s.
  std::filesystem::path output;  ///< A folder; made if missing.
};
/// Plan -> how the face answers its segment's motion to first order; preview.json is written last.
[[nodiscard]] Result<Summary> prepare_preview(const PreviewJob& job, Progress& progress);

}  // namespace lefort::pipeline
