#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/find_teeth.h>
#include <lefort/anatomy/histogram_thresholds.h>
#include <lefort/anatomy/reduce_metal_streaks.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/anatomy/tissue_volumes.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/pipeline/scan/surface_summary.h>
#include <lefort/pipeline/segment.h>
#include <lefort/pipeline/timing/peak_memory.h>
#include <lefort/pipeline/timing/stage_timer.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::pipeline {
namespace {

/// Reduces metal streaks in place; returns the number of slices with streaks.
Index reduce_streaks(image::CtVolume& ct, const anatomy::SegmentationOptions& options,
                     Progress& progress) {
  anatomy::StreakReduction reduced =
      anatomy::reduce_metal_streaks(ct, options.bone_hu, options.skin_hu);
  if (reduced.slices > 0)
    progress.note(fmt::format("{} slices have metal streaks; they are reduced", reduced.slices));
  ct = std::move(reduced.ct);
  return reduced.slices;
}

/// Adds the volumes of all tissues and of the teeth.
void add_volumes(const anatomy::LabelMap& labels, const anatomy::ToothMap& teeth,
                 Summary& summary) {
  auto volumes = anatomy::tissue_volumes_ml(labels);
  for (const auto& [tooth, name, color] : anatomy::kToothStyles) {
    const auto voxels = std::count(teeth.values.begin(), teeth.values.end(), tooth);
    volumes.emplace_back(name, double(voxels) * teeth.grid.spacing_mm.prod() * 1e-3);
  }
  for (const auto& [name, volume_ml] : volumes) {
    summary.text += fmt::format("\n  {:<12} {:8.1f} ml", name, volume_ml);
    summary.json["volumes_ml"][name] = volume_ml;
  }
}

}  // namespace

Result<Summary> segment_scan(const SegmentJob& job, Progress& shown) {
  StageTimer progress(shown);
  progress.begin_stage("import");
  LEFORT_TRY(io::ImportedVolume scan, io::import_volume(job.ct, progress));
  for (const std::string& warning : scan.warnings) progress.note("warning: " + warning);
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));

  progress.begin_stage("segment");
  anatomy::SegmentationOptions options = job.options;
  if (job.auto_thresholds) {
    LEFORT_TRY(const anatomy::HistogramThresholds found, anatomy::find_thresholds(scan.ct));
    options.bone_hu = found.bone_hu;
    options.skin_hu = found.skin_hu;
  }
  const Index streaks = reduce_streaks(scan.ct, options, progress);
  LEFORT_TRY(const anatomy::LabelMap labels,
             job.labels ? io::read_segmentation(*job.labels, scan.ct.grid, progress)
                        : anatomy::segment_tissue(scan.ct, options, progress));
  const anatomy::ToothMap teeth = anatomy::find_teeth(scan.ct, labels, options.bone_hu);
  const anatomy::LevelOptions levels{.bone_hu = options.bone_hu, .skin_hu = options.skin_hu};
  const double voxel_mm = scan.ct.grid.spacing_mm.minCoeff();
  const auto surface_of = [&](const image::ScalarVolume& level) -> Result<mesh::FinishedSurface> {
    progress.begin_stage("extract a surface");
    LEFORT_TRY(const geometry::TriangleMesh isosurface_L,
               anatomy::extract_isosurface(level, {}, progress));
    progress.begin_stage("smooth and check it");
    return mesh::finish_surface(isosurface_L, voxel_mm, job.finish, progress);
  };
  LEFORT_TRY(const mesh::FinishedSurface skull,
             surface_of(anatomy::bone_level(scan.ct, labels, anatomy::Cavities::kKeep, levels)));
  LEFORT_TRY(const mesh::FinishedSurface skin,
             surface_of(anatomy::skin_level(scan.ct, labels, levels)));

  progress.begin_stage("write");
  LEFORT_TRY_VOID(io::write_segmentation(job.output / "labels.seg.nrrd", labels));
  LEFORT_TRY_VOID(io::write_teeth(job.output / "teeth.seg.nrrd", teeth));
  LEFORT_TRY_VOID(io::write_surface(job.output / "skull.vtp", skull.mesh_L));
  LEFORT_TRY_VOID(io::write_surface(job.output / "skin.vtp", skin.mesh_L));

  Summary summary;
  summary.text = fmt::format("{}:\n  skull  {}\n  skin   {}", job.output.string(), text_of(skull),
                             text_of(skin));
  summary.json = {{"output", job.output.string()},
                  {"thresholds_hu", {{"bone", options.bone_hu}, {"skin", options.skin_hu}}},
                  {"skull", json_of(skull)},
                  {"skin", json_of(skin)},
                  {"seconds", progress.seconds_json()},
                  {"slices_with_streaks", streaks},
                  {"peak_memory_mb", peak_memory_mb()}};
  add_volumes(labels, teeth, summary);
  return summary;
}

}  // namespace lefort::pipeline
