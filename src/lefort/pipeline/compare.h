/// \file
/// Distance between two faces.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

struct CompareJob {
  std::filesystem::path face;                     ///< A surface, or the folder of a prediction.
  std::optional<std::filesystem::path> other;     ///< The other face; as `face`.
  std::optional<std::filesystem::path> after_ct;  ///< Scan after surgery, instead of `other`.
  /// The skin before surgery, for the baseline; default: that of the prediction `face`.
  std::optional<std::filesystem::path> before;
  /// Before surgery; they define the regions. Default: those of the plan of the prediction `face`.
  std::optional<std::filesystem::path> landmarks;
  std::filesystem::path output;  ///< A folder; made if missing.
  bool pictures = true;
};

/// Measures the distance between two faces, by region; with a scan after surgery also the movement
/// of each segment.
///
/// \returns the summary, or
///   - kInvalidArgument  neither or both of `other` and `after_ct` are given, a folder is not that
///     of a finished prediction, `face` is not a folder although `after_ct` is given, an input is
///     one of the files to be written, or no point has a counterpart within 20 mm;
///   - kFileNotFound, kFileUnsupported, kFileCorrupt, kMeshInvalid  from reading surfaces and
///     landmarks;
///   - kPlanInvalid      the plan of the prediction `face` is invalid, or right and left landmarks
///     are exchanged;
///   - the errors of find_surgery() (pipeline/compare/register_after_surgery.h);
///   - kFileUnwritable   a result cannot be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<Summary> compare_faces(const CompareJob& job, Progress& progress);

}  // namespace lefort::pipeline
