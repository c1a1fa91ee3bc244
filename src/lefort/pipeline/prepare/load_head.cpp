#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/reduce_metal_streaks.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/tissue_volumes.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/cache/stage_keys.h>
#include <lefort/pipeline/prepare/load_head.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

Result<anatomy::LabelMap> find_labels(const io::PlanFile& plan, const image::CtVolume& ct,
                                      const std::string& ct_sha256, const StageCache* cache,
                                      Progress& progress) {
  progress.begin_stage("segment");
  if (plan.labels) return io::read_segmentation(*plan.labels, ct.grid, progress);
  const anatomy::SegmentationOptions& options = plan.segmentation;
  if (cache == nullptr) return anatomy::segment_tissue(ct, options, progress);
  return cache->get(
      "labels.seg.nrrd", labels_key(ct_sha256, options), progress,
      [&](const fs::path& path) { return io::read_segmentation(path, ct.grid); },
      [&] { return anatomy::segment_tissue(ct, options, progress); },
      [](const fs::path& path, const anatomy::LabelMap& labels) {
        return io::write_segmentation(path, labels);
      });
}

}  // namespace

bool has_mandible(const anatomy::LabelMap& labels) {
  const auto& values = labels.values;
  return std::find(values.begin(), values.end(), anatomy::Tissue::kMandible) != values.end();
}

Result<ScannedLabels> scan_labels(const io::PlanFile& plan, const fs::path& ct_path,
                                  const StageCache* cache, Progress& progress) {
  progress.begin_stage("import");
  LEFORT_TRY(io::ImportedVolume scan, io::import_volume(ct_path, progress));
  for (const std::string& warning : scan.warnings) progress.note("warning: " + warning);
  std::string ct_sha256 = io::Sha256().add(scan.ct).hex();
  scan.ct =
      anatomy::reduce_metal_streaks(scan.ct, plan.segmentation.bone_hu, plan.segmentation.skin_hu)
          .ct;
  LEFORT_TRY(anatomy::LabelMap labels, find_labels(plan, scan.ct, ct_sha256, cache, progress));
  return ScannedLabels{
      std::move(scan),
      std::move(ct_sha256),
      std::move(labels),
      {.bone_hu = plan.segmentation.bone_hu, .skin_hu = plan.segmentation.skin_hu}};
}

Result<ScannedHead> scan_head(const io::PlanFile& plan, const fs::path& ct_path,
                              const StageCache& cache, Progress& progress) {
  LEFORT_TRY(ScannedLabels head, scan_labels(plan, ct_path, &cache, progress));
  progress.begin_stage("extract surfaces");
  const auto surface_of = [&](anatomy::Cavities cavities, anatomy::Bones bones) {
    return anatomy::extract_isosurface(
        anatomy::bone_level(head.scan.ct, head.labels, cavities, head.levels, bones), {}, progress);
  };
  const bool is_apart = plan::takes_mandible(plan.segments) && has_mandible(head.labels);
  std::optional<geometry::TriangleMesh> mandible_L;
  if (is_apart) {
    LEFORT_TRY(mandible_L, surface_of(anatomy::Cavities::kKeep, anatomy::Bones::kMandible));
  }
  LEFORT_TRY(geometry::TriangleMesh skull_L,
             surface_of(anatomy::Cavities::kFillSinuses,
                        is_apart ? anatomy::Bones::kSkull : anatomy::Bones::kAll));
  return ScannedHead{std::move(head.scan), std::move(head.ct_sha256), std::move(head.labels),
                     head.levels,          std::move(skull_L),        std::move(mandible_L)};
}

void note_fragments(const plan::CutSegments& cut, std::span<const plan::PlannedSegment> planned,
                    Progress& progress) {
  for (std::size_t k = 0; k < cut.cuts.size(); ++k) {
    const std::vector<plan::Fragment>& fragments = cut.cuts[k].fragments;
    if (fragments.empty()) continue;
    double all_mm3 = 0.0;
    std::array<int, 3> count_of{};
    const plan::Fragment* largest = &fragments.front();
    for (const plan::Fragment& one : fragments) {
      all_mm3 += one.volume_mm3;
      ++count_of[std::size_t(one.owner)];
      if (one.volume_mm3 > largest->volume_mm3) largest = &one;
    }
    progress.note(fmt::format(
        "osteotomy of '{}': {} fragments, {:.2f} ml: {} stay with the other bone, {} move with the "
        "segment, {} are left out; the largest has {:.2f} ml, at ({:.0f}, {:.0f}, {:.0f}) mm",
        planned[k].osteotomy.segment, fragments.size(), all_mm3 * 1e-3, count_of[0], count_of[1],
        count_of[2], largest->volume_mm3 * 1e-3, largest->center_L.x(), largest->center_L.y(),
        largest->center_L.z()));
  }
}

void note_mixed_labels(const anatomy::LabelMap& labels, const std::string& segment,
                       const geometry::TriangleMesh& segment_L, Progress& progress) {
  constexpr double kMin_ml = 1.0, kMinFraction = 0.1;  // Less is the blur between two labels.
  if (!has_mandible(labels)) return;
  const anatomy::BoneVolumes found = anatomy::bone_volumes_within(labels, segment_L);
  const double less_ml = std::min(found.skull_ml, found.mandible_ml);
  if (less_ml < kMin_ml || less_ml < kMinFraction * (found.skull_ml + found.mandible_ml)) return;
  progress.note(fmt::format(
      "warning: segment '{}' contains {:.1f} ml labeled as mandible and {:.1f} ml labeled as bone "
      "of the skull: check the labels at joints and teeth, and the cut",
      segment, found.mandible_ml, found.skull_ml));
}

}  // namespace lefort::pipeline
