/// \file
/// The canals of the inferior alveolar nerves in a scan.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

struct NerveJob {
  std::filesystem::path ct;                     ///< Anything `lefort import` reads.
  std::optional<std::filesystem::path> labels;  ///< .seg.nrrd; segmented unless given.
  /// Pg, Go, Co, MdF (mandibular foramen), MeF (mental foramen), and points on a canal: IAN-R-1,
  /// IAN-R-2 from posterior to anterior. What is missing is found.
  std::optional<std::filesystem::path> landmarks;
  std::filesystem::path output;  ///< A folder; made if missing.
};

/// Finds both canals (anatomy::trace_nerve()). Writes `nerve_right.vtp` and `nerve_left.vtp` (tubes
/// of 3 mm, with the CT number along them), `nerve.mrk.json` (foramina and a point every 10 mm, to
/// correct in 3D Slicer and to give again as landmarks) and `nerve.json`.
///
/// \returns the summary, or
///   - the errors of oriented_head() and anatomy::trace_nerve();
///   - kAnatomyMissing   the labels have no mandible, or a landmark is missing;
///   - kInvalidArgument  a point IAN has no number, or the landmarks would be overwritten;
///   - kFileUnwritable   a result cannot be written.
[[nodiscard]] Result<Summary> trace_nerves(const NerveJob& job, Progress& progress);

}  // namespace lefort::pipeline
