#include <lefort/io/import_volume.h>
#include <lefort/io/volume_files.h>
#include <lefort/pipeline/import.h>
#include <lefort/pipeline/timing/peak_memory.h>
#include <lefort/pipeline/timing/stage_timer.h>

#include <fmt/format.h>

#include <string>
#include <vector>

namespace lefort::pipeline {

namespace {

std::vector<double> list_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

io::ImportOptions options_of(const ImportJob& job) {
  return {.series = job.series, .credentials = {.user = job.user, .password = job.password}};
}

/// Grid of the voxels, and the orientation of the original slices.
nlohmann::json geometry_json(const io::ImportedVolume& scan) {
  const image::Grid& grid = scan.ct.grid;
  const Vec3 extent_mm = Vec3(double(grid.size[0]), double(grid.size[1]), double(grid.size[2]))
                             .cwiseProduct(grid.spacing_mm);
  nlohmann::json json{{"origin_lps_mm", list_of(grid.origin_L)},
                      {"extent_mm", list_of(extent_mm)},
                      {"axes_lps",
                       {list_of(grid.direction.col(0)), list_of(grid.direction.col(1)),
                        list_of(grid.direction.col(2))}}};
  if (scan.stack)
    json["slices"] = {{"count", scan.stack->slices},
                      {"min_step_mm", scan.stack->min_step_mm},
                      {"max_step_mm", scan.stack->max_step_mm},
                      {"tilt_deg", scan.stack->tilt_deg},
                      {"resampled", scan.stack->resampled}};
  return json;
}

}  // namespace

Result<Summary> import_scan(const ImportJob& job, Progress& shown) {
  StageTimer progress(shown);
  progress.begin_stage("import");
  LEFORT_TRY(const io::ImportedVolume scan,
             io::import_volume(job.source, options_of(job), progress));
  for (const std::string& warning : scan.warnings) progress.note("warning: " + warning);
  progress.begin_stage("write");
  LEFORT_TRY_VOID(io::write_volume(job.output, scan.ct));

  const image::Grid& grid = scan.ct.grid;
  Summary summary;
  summary.text =
      fmt::format("{}: {} x {} x {} voxels of {:.3f} x {:.3f} x {:.3f} mm, from {}",
                  job.output.string(), grid.size[0], grid.size[1], grid.size[2],
                  grid.spacing_mm.x(), grid.spacing_mm.y(), grid.spacing_mm.z(), scan.source_kind);
  summary.json = {{"output", job.output.string()},      {"source_kind", scan.source_kind},
                  {"size_voxels", grid.size},           {"spacing_mm", list_of(grid.spacing_mm)},
                  {"geometry", geometry_json(scan)},    {"warnings", scan.warnings},
                  {"seconds", progress.seconds_json()}, {"peak_memory_mb", peak_memory_mb()}};
  return summary;
}

Result<Summary> list_scans(const ImportJob& job, Progress& progress) {
  LEFORT_TRY(const std::vector<io::DicomSeriesInfo> all,
             io::list_scans(job.source, options_of(job), progress));
  Summary summary;
  summary.text = fmt::format("{:>6}  {:<10} {:>6}  {:<11} {:<8} {:<13} {:>7}  {}", "series",
                             "modality", "images", "pixels", "kernel", "pixel [mm]", "step", "");
  summary.json["series"] = nlohmann::json::array();
  for (const io::DicomSeriesInfo& one : all) {
    const std::string pixel =
        one.pixel_mm ? fmt::format("{:.3f} x {:.3f}", (*one.pixel_mm)[0], (*one.pixel_mm)[1]) : "";
    std::string remark = one.orientation;
    for (const std::string& more : one.warnings) remark += (remark.empty() ? "" : "; ") + more;
    if (!one.problem.empty()) remark = one.problem;
    summary.text += fmt::format(
        "\n{:>6}  {:<10} {:>6}  {:<11} {:<8} {:<13} {:>7}  {}", one.number, one.modality,
        one.images, one.columns > 0 ? fmt::format("{} x {}", one.columns, one.rows) : "",
        one.kernel, pixel, one.step_mm ? fmt::format("{:.3f}", *one.step_mm) : "", remark);
    nlohmann::json json{
        {"number", one.number},           {"modality", one.modality}, {"images", one.images},
        {"columns", one.columns},         {"rows", one.rows},         {"kernel", one.kernel},
        {"orientation", one.orientation}, {"usable", one.is_usable},  {"problem", one.problem},
        {"warnings", one.warnings}};
    if (one.pixel_mm) json["pixel_mm"] = *one.pixel_mm;
    if (one.step_mm) json["step_mm"] = *one.step_mm;
    summary.json["series"].push_back(json);
  }
  return summary;
}

}  // namespace lefort::pipeline
