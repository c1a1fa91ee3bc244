#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/app/output_folder.h>
#include <lefort/app/pipeline.h>
#include <lefort/app/tissue_volumes.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/surface_files.h>

#include <fmt/format.h>

namespace lefort::app {

Result<Summary> segment_scan(const SegmentJob& job, Progress& progress) {
  progress.begin_stage("import");
  LEFORT_TRY(const io::ImportedVolume scan, io::import_volume(job.ct, progress));
  for (const std::string& warning : scan.warnings) progress.note("warning: " + warning);
  LEFORT_TRY_VOID(make_output_folder(job.output));

  progress.begin_stage("segment");
  LEFORT_TRY(const anatomy::LabelMap labels,
             job.labels ? io::read_segmentation(*job.labels, scan.ct.grid, progress)
                        : anatomy::segment_tissue(scan.ct, job.options, progress));
  const anatomy::LevelOptions levels{.bone_hu = job.options.bone_hu,
                                     .skin_hu = job.options.skin_hu};
  progress.begin_stage("extract surfaces");
  LEFORT_TRY(
      const geometry::TriangleMesh skull_L,
      anatomy::extract_isosurface(
          anatomy::bone_level(scan.ct, labels, anatomy::Cavities::kKeep, levels), {}, progress));
  LEFORT_TRY(
      const geometry::TriangleMesh skin_L,
      anatomy::extract_isosurface(anatomy::skin_level(scan.ct, labels, levels), {}, progress));

  progress.begin_stage("write");
  LEFORT_TRY_VOID(io::write_segmentation(job.output / "labels.seg.nrrd", labels));
  LEFORT_TRY_VOID(io::write_surface(job.output / "skull.vtp", skull_L));
  LEFORT_TRY_VOID(io::write_surface(job.output / "skin.vtp", skin_L));

  Summary summary;
  summary.text = fmt::format("{}: skull {} triangles, skin {} triangles", job.output.string(),
                             skull_L.triangle_count(), skin_L.triangle_count());
  summary.json = {{"output", job.output.string()},
                  {"skull_triangles", skull_L.triangle_count()},
                  {"skin_triangles", skin_L.triangle_count()}};
  for (const auto& [name, volume_ml] : tissue_volumes_ml(labels)) {
    summary.text += fmt::format("\n  {:<12} {:8.1f} ml", name, volume_ml);
    summary.json["volumes_ml"][name] = volume_ml;
  }
  return summary;
}

}  // namespace lefort::app
