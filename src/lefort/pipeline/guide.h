/// \file
/// Cutting guides of a plan.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/dental/cutting_guide.h>
#include <lefort/dental/guide_holes.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>
#include <string>

namespace lefort::pipeline {

struct GuideJob {
  std::filesystem::path plan;
  std::optional<std::filesystem::path> ct;     ///< Instead of the plan's.
  std::optional<std::filesystem::path> nerve;  ///< nerve.json of trace_nerves().
  /// teeth_corrections.json of number_teeth_of_scan().
  std::optional<std::filesystem::path> tooth_corrections = std::nullopt;
  std::string segment;  ///< Empty: each segment that is cut.
  /// The side from which the guide is put on: "anterior", "right", "left", "inferior"; empty: right
  /// and left for a sagittal split, anterior for other osteotomies.
  std::string from;
  dental::GuideOptions guide;
  dental::HoleOptions holes;
  std::optional<std::filesystem::path> cache;  ///< A folder; cache/ of the output unless given.
  std::filesystem::path output;                ///< A folder; made if missing.
};

/// Makes cutting guides (dental::make_guide()) for the lines of the cuts that are visible from one
/// side. Writes `guide_SEGMENT_SIDE.stl`, `guides.json`, and the centers of the holes before and
/// after the movement as `holes_before.mrk.json` and `holes_after.mrk.json`: holes on a segment
/// move with it, so that the plate can be bent or printed before surgery.
///
/// \returns the summary, or
///   - kPlanInvalid      the plan is invalid, or has no segment of that name;
///   - kInvalidArgument  an option is out of range, the segment is not cut or cut by bounded
///     planes, or the canals were found in another scan;
///   - kCutMissesBone    no line of the cut is visible from that side;
///   - the errors of read_plan_of_scan(), scan_head(), plan::cut_segments(), make_guide();
///   - kFileUnwritable   a result cannot be written.
[[nodiscard]] Result<Summary> make_guides(const GuideJob& job, Progress& progress);

}  // namespace lefort::pipeline
