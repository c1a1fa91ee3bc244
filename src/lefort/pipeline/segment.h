/// \file
/// Segmentation of a scan, and the surfaces of bone and skin.
#pragma once

#include <lefort/anatomy/segment_tissue.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/mesh/finish_surface.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

struct SegmentJob {
  std::filesystem::path ct;      ///< A scan in any format of io::import_volume().
  std::filesystem::path output;  ///< A folder; made if missing.
  anatomy::SegmentationOptions options;
  mesh::SurfaceFinish finish;
  bool auto_thresholds = false;  ///< From the histogram, instead of those of the options.
  std::optional<std::filesystem::path> labels;  ///< Used instead of a segmentation.
};

/// Reduces metal streaks and segments a scan; writes labels.seg.nrrd, teeth.seg.nrrd, skull.vtp and
/// skin.vtp, in frame L [mm].
///
/// \returns the summary, or
///   - the errors of io::import_volume();
///   - the errors of io::read_segmentation(), with `labels`;
///   - kAnatomyMissing   the scan is empty or constant, contains no skin, no bone or no air around
///     the patient, or has too few different values for `auto_thresholds`;
///   - kInvalidArgument  an option is out of range, or the scan is too large for the memory limit;
///   - kMeshInvalid      no surface of bone or skin was found;
///   - kMeshingFailed    the surface could not be simplified;
///   - kFileUnwritable   a result cannot be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<Summary> segment_scan(const SegmentJob& job, Progress& progress);

}  // namespace lefort::pipeline
