/// \file
/// Cephalograms and cephalometric analysis of a scan.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>
#include <lefort/plan/cephalometric_norms.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

struct CephalogramJob {
  std::filesystem::path ct;                         ///< Anything `lefort import` reads.
  std::optional<std::filesystem::path> labels;      ///< .seg.nrrd; segmented unless given.
  std::optional<std::filesystem::path> landmarks;   ///< What is missing is found.
  std::optional<std::filesystem::path> check;       ///< Folder of `lefort plan check`.
  std::optional<std::filesystem::path> prediction;  ///< Folder of `lefort predict`.
  std::optional<double> source_mm = 1524.0;  ///< From the mid-sagittal plane; none: parallel.
  plan::Sex sex = plan::Sex::kFemale;        ///< Of the norms.
  std::filesystem::path output;              ///< A folder; made if missing.
};

/// Computes the lateral and the frontal cephalogram, traces bone and skin before and after surgery
/// in the mid-sagittal plane, and compares the measurements with published norms. Writes
/// `lateral.png`, `frontal.png`, `tracing.png`, `measurements.csv`, `norms.csv`,
/// `cephalometry.pdf` and `cephalogram.json`.
///
/// \returns the summary, or
///   - the errors of oriented_head(), of extracting the surfaces, and of reading `check` and
///     `prediction`;
///   - kInvalidArgument  `check` without `landmarks` and `prediction`;
///   - kFileUnwritable   a result cannot be written.
[[nodiscard]] Result<Summary> make_cephalogram(const CephalogramJob& job, Progress& progress);

}  // namespace lefort::pipeline
