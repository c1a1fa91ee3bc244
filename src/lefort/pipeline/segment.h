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
  std::filesystem::path ct;
  std::filesystem::path output;  ///< A folder; made if missing.
  anatomy::SegmentationOptions options;
  mesh::SurfaceFinish finish;
  bool auto_thresholds = false;  ///< From the histogram, instead of those of the options.
  std::optional<std::filesystem::path> labels;  ///< Used instead of a segmentation.
};

/// Segments a scan; writes labels.seg.nrrd, skull.vtp and skin.vtp.
[[nodiscard]] Result<Summary> segment_scan(const SegmentJob& job, Progress& progress);

}  // namespace lefort::pipeline
