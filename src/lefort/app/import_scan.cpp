#include <lefort/app/pipeline.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/volume_files.h>

#include <fmt/format.h>

namespace lefort::app {

Result<Summary> import_scan(const ImportJob& job, Progress& progress) {
  progress.begin_stage("import");
  LEFORT_TRY(const io::ImportedVolume scan,
             io::import_volume(job.source, {.series = job.series}, progress));
  for (const std::string& warning : scan.warnings) progress.note("warning: " + warning);
  LEFORT_TRY_VOID(io::write_volume(job.output, scan.ct));

  const image::Grid& grid = scan.ct.grid;
  Summary summary;
  summary.text =
      fmt::format("{}: {} x {} x {} voxels of {:.3f} x {:.3f} x {:.3f} mm, from {}",
                  job.output.string(), grid.size[0], grid.size[1], grid.size[2],
                  grid.spacing_mm.x(), grid.spacing_mm.y(), grid.spacing_mm.z(), scan.source_kind);
  summary.json = {{"output", job.output.string()},
                  {"source_kind", scan.source_kind},
                  {"size_voxels", grid.size},
                  {"spacing_mm", {grid.spacing_mm.x(), grid.spacing_mm.y(), grid.spacing_mm.z()}},
                  {"warnings", scan.warnings}};
  return summary;
}

}  // namespace lefort::app
