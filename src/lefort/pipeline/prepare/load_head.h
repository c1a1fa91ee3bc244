/// \file
/// Scan, labels and skull before the osteotomies.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/imported_volume.h>
#include <lefort/io/plan_file.h>
#include <lefort/pipeline/cache/stage_cache.h>
#include <lefort/plan/cut_segments.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace lefort::pipeline {

/// A scan and its labels.
struct ScannedLabels {
  io::ImportedVolume scan;  ///< With metal streaks reduced.
  std::string ct_sha256;    ///< Of the imported scan, before that reduction.
  anatomy::LabelMap labels;
  anatomy::LevelOptions levels;
};

/// Imports the scan, reduces metal streaks, and reads or segments the labels.
///
/// \param plan   names the labels, or has the options to segment them.
/// \param ct     the scan.
/// \param cache  for the labels; null: they are not stored.
/// \returns scan and labels; or the errors of io::import_volume(), and of io::read_segmentation()
///   or anatomy::segment_tissue().
[[nodiscard]] Result<ScannedLabels> scan_labels(const io::PlanFile& plan,
                                                const std::filesystem::path& ct,
                                                const StageCache* cache, Progress& progress);

/// \returns whether a voxel is labeled as mandible.
[[nodiscard]] bool has_mandible(const anatomy::LabelMap& labels);

/// A head before the osteotomies.
struct ScannedHead {
  io::ImportedVolume scan;  ///< As in ScannedLabels.
  std::string ct_sha256;    ///< As in ScannedLabels.
  anatomy::LabelMap labels;
  anatomy::LevelOptions levels;
  geometry::TriangleMesh skull_L;
  /// If the plan moves the mandible as a whole; `skull_L` is then without it.
  std::optional<geometry::TriangleMesh> mandible_L{};

  [[nodiscard]] const geometry::TriangleMesh* mandible() const {
    return mandible_L ? &*mandible_L : nullptr;
  }
};

/// Imports and segments a scan, and extracts the surface of the bone.
///
/// \param plan   names the labels, or has the options of the segmentation.
/// \param ct     the scan.
/// \param cache  of the labels.
/// \returns the head; or the errors of scan_labels() and anatomy::extract_isosurface().
[[nodiscard]] Result<ScannedHead> scan_head(const io::PlanFile& plan,
                                            const std::filesystem::path& ct,
                                            const StageCache& cache, Progress& progress);

/// Reports the fragments of each osteotomy with the parts of the bone they belong to.
void note_fragments(const plan::CutSegments& cut, std::span<const plan::PlannedSegment> planned,
                    Progress& progress);

/// Warns if a segment contains much bone labeled as skull and much labeled as mandible: the labels
/// at the joints or between the teeth, or the cut, are then probably wrong.
void note_mixed_labels(const anatomy::LabelMap& labels, const std::string& segment,
                       const geometry::TriangleMesh& segment_L, Progress& progress);

}  // namespace lefort::pipeline
