/// \file
/// Landmarks, the check of a plan, and its cut bones.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>
#include <lefort/predict/check_plan.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// Format version of check.json.
inline constexpr int kPlanCheckVersion = 2;

struct LandmarksJob {
  std::filesystem::path before;                 ///< .mrk.json or .csv; empty with `find`.
  std::optional<std::filesystem::path> find;    ///< A scan in which the landmarks are found.
  std::optional<std::filesystem::path> labels;  ///< Of that scan; segmented unless given.
  std::optional<std::filesystem::path> after;   ///< As `before`.
  std::optional<std::filesystem::path> output;  ///< .csv: the measurements.
  /// .mrk.json or .csv: a copy of the landmarks of `after`; without it, of `before` or `find`.
  std::optional<std::filesystem::path> save;
};

/// Measures angles [degrees] and distances [mm] between landmarks that are read, or found in a
/// scan.
///
/// \returns the summary, or
///   - kInvalidArgument  `output` does not end in .csv;
///   - kFileNotFound     a file of landmarks does not exist;
///   - kFileUnsupported  another ending, or lengths in an unknown unit;
///   - kFileCorrupt      a file is not of its format, or a name is missing or repeated;
///   - kPlanInvalid      right and left landmarks are exchanged;
///   - the errors of scan_labels() and find_head_landmarks(), with `find`;
///   - kFileUnwritable   an output cannot be written.
[[nodiscard]] Result<Summary> measure_landmarks(const LandmarksJob& job, Progress& progress);

/// A splint or a cutting guide that belongs to a plan.
struct PrintedPart {
  std::string kind;  ///< "splint" or "guide".
  std::filesystem::path file;
  std::string name = {};  ///< As the worksheet names it; empty: folder and name of the file.
};

struct CheckPlanJob {
  std::filesystem::path plan;
  std::optional<std::filesystem::path> ct;     ///< Instead of the plan's.
  std::optional<std::filesystem::path> skull;  ///< A closed surface, instead of any scan.
  std::optional<std::filesystem::path> nerve = std::nullopt;  ///< nerve.json of trace_nerves().
  /// teeth_corrections.json of number_teeth_of_scan().
  std::optional<std::filesystem::path> tooth_corrections = std::nullopt;
  std::vector<PrintedPart> printed = {};       ///< Listed in the worksheet; not checked.
  std::filesystem::path output;                ///< A folder; made if missing.
  std::optional<std::filesystem::path> cache;  ///< A folder; cache/ of the output unless given.
  predict::PlanLimits limits;
  bool pictures = true;
};

struct PlanCheckSummary {
  Summary summary;
  bool has_findings = false;  ///< Overlap, gap or missing support beyond the limits.
};

/// Checks for overlap along the paths of the segments, and for gaps and missing support at their
/// ends, and for the distances of cuts from tooth roots and nerves; writes check.json, surfaces,
/// pictures, and the movements as planned_movements.csv and worksheet.pdf.
///
/// \returns the summary, or
///   - kFileNotFound     plan, scan, skull or a printed part does not exist;
///   - kPlanInvalid      the plan is invalid or names no scan, or as plan::cut_segments();
///   - kInvalidArgument  an input is a file that an earlier check has written, or an option of the
///     cut lies outside its range;
///   - kFileUnsupported, kFileCorrupt, kAnatomyMissing  from reading the scan and its labels, and
///     from anatomy::segment_tissue();
///   - kMeshInvalid, kCutMissesBone, kMeshingFailed  from plan::cut_segments();
///   - kFileUnwritable   a file in the folder is not of an earlier check, or cannot be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<PlanCheckSummary> check_plan_file(const CheckPlanJob& job, Progress& progress);

struct CutJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path cache;   ///< Folder of cached stages.
  std::filesystem::path output;  ///< A folder; made if missing.
};

/// Writes the bones of a plan at their scanned pose, and their distance fields into the cache, so
/// that the planner can move the bones. cut.json, which is written last, names the files.
///
/// \returns the summary; the errors of io::read_plan(), scan_head(), plan::cut_segments() and
///   find_field(); or kFileUnwritable.
[[nodiscard]] Result<Summary> cut_plan(const CutJob& job, Progress& progress);

}  // namespace lefort::pipeline
