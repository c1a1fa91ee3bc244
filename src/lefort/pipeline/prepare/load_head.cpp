#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/cache/stage_keys.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/plan/cut_segments.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

Result<anatomy::LabelMap> find_labels(const io::PlanFile& plan, const image::CtVolume& ct,
                                      const std::string& ct_sha256, const StageCache& cache,
                                      Progress& progress) {
  progress.begin_stage("segment");
  if (plan.labels) return io::read_segmentation(*plan.labels, ct.grid, progress);
  const anatomy::SegmentationOptions& options = plan.segmentation;
  return cache.get(
      "labels.seg.nrrd", labels_key(ct_sha256, options), progress,
      [&](const fs::path& path) { return io::read_segmentation(path, ct.grid); },
      [&] { return anatomy::segment_tissue(ct, options, progress); },
      [](const fs::path& path, const anatomy::LabelMap& labels) {
        return io::write_segmentation(path, labels);
      });
}

/// The surface of the labeled bone, without that of `excluded`.
Result<geometry::TriangleMesh> bone_surface(const image::CtVolume& ct, anatomy::LabelMap labels,
                                            std::optional<anatomy::Tissue> excluded,
                                            anatomy::Cavities cavities,
                                            const anatomy::LevelOptions& levels,
                                            Progress& progress) {
  if (excluded)
    std::replace(labels.values.begin(), labels.values.end(), *excluded,
                 anatomy::Tissue::kSoftTissue);
  return anatomy::extract_isosurface(anatomy::bone_level(ct, labels, cavities, levels), {},
                                     progress);
}

/// The mandible as a bone of its own, if it is labeled.
Result<std::optional<geometry::TriangleMesh>> mandible_surface(const image::CtVolume& ct,
                                                               const anatomy::LabelMap& labels,
                                                               const anatomy::LevelOptions& levels,
                                                               Progress& progress) {
  const auto& values = labels.values;
  if (std::find(values.begin(), values.end(), anatomy::Tissue::kMandible) == values.end())
    return std::nullopt;
  LEFORT_TRY(
      geometry::TriangleMesh mandible_L,
      bone_surface(ct, labels, anatomy::Tissue::kBone, anatomy::Cavities::kKeep, levels, progress));
  return mandible_L;
}

}  // namespace

Result<ScannedHead> scan_head(const io::PlanFile& plan, const fs::path& ct_path,
                              const StageCache& cache, Progress& progress) {
  progress.begin_stage("import");
  LEFORT_TRY(io::ImportedVolume scan, io::import_volume(ct_path, progress));
  for (const std::string& warning : scan.warnings) progress.note("warning: " + warning);
  std::string ct_sha256 = io::Sha256().add(scan.ct).hex();
  LEFORT_TRY(anatomy::LabelMap labels, find_labels(plan, scan.ct, ct_sha256, cache, progress));

  progress.begin_stage("extract surfaces");
  const anatomy::LevelOptions levels{.bone_hu = plan.segmentation.bone_hu,
                                     .skin_hu = plan.segmentation.skin_hu};
  std::optional<geometry::TriangleMesh> mandible_L;
  if (plan::takes_mandible(plan.segments)) {
    LEFORT_TRY(mandible_L, mandible_surface(scan.ct, labels, levels, progress));
  }
  LEFORT_TRY(geometry::TriangleMesh skull_L,
             bone_surface(scan.ct, labels,
                          mandible_L ? std::optional(anatomy::Tissue::kMandible) : std::nullopt,
                          anatomy::Cavities::kFillSinuses, levels, progress));
  return ScannedHead{std::move(scan), std::move(ct_sha256), std::move(labels),
                     levels,          std::move(skull_L),   std::move(mandible_L)};
}

void note_fragments(const plan::OsteotomyResult& bones, Progress& progress) {
  if (bones.fragments == 0) return;
  progress.note(fmt::format(
      "{} pieces of bone within the cut, {:.2f} ml together, do not move: they are "
      "smaller than osteotomy.min_piece_ml or min_piece_fraction, or without an anchor point",
      bones.fragments, bones.fragment_volume_mm3 * 1e-3));
}

}  // namespace lefort::pipeline
