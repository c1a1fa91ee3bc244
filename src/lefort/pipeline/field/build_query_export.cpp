#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/export_field.h>
#include <lefort/io/field_file.h>
#include <lefort/io/point_table.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/field.h>
#include <lefort/pipeline/field/field_region.h>

#include <fmt/format.h>

#include <array>
#include <vector>

namespace lefort::pipeline {
namespace {

constexpr std::array<const char*, 4> kZoneNames{"band", "outside", "inside", "unknown"};

std::string row(const Vec3& p, field::Zone zone, double distance_mm, const Vec3& gradient) {
  return fmt::format("{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{},{}\n", p.x(),
                     p.y(), p.z(), distance_mm, gradient.x(), gradient.y(), gradient.z(),
                     zone == field::Zone::kBand ? 1 : 0, kZoneNames.at(std::size_t(zone)));
}

}  // namespace

Result<Summary> build_field(const BuildFieldJob& job, Progress& progress) {
  progress.begin_stage("read the surface");
  LEFORT_TRY(const geometry::TriangleMesh surface, io::read_surface(job.surface, progress));
  progress.begin_stage("build the distance field");
  LEFORT_TRY(const field::DistanceField distance,
             field::build_distance_field(surface, job.options, progress));
  LEFORT_TRY_VOID(io::write_field(job.output, distance));

  Summary summary;
  summary.text = fmt::format("{}: {} triangles, cell {:.4f} mm, samples to {:.3f} mm, {:.1f} MB",
                             job.output.string(), surface.triangle_count(), distance.cell_mm(),
                             distance.band_mm(), double(distance.sample_bytes()) * 1e-6);
  summary.json = {{"output", job.output.string()},
                  {"triangles", surface.triangle_count()},
                  {"closed", distance.frame().closed},
                  {"resolution", distance.frame().resolution},
                  {"cell_mm", distance.cell_mm()},
                  {"band_mm", distance.band_mm()},
                  {"guaranteed_mm", distance.guaranteed_mm()},
                  {"tolerance_mm", distance.frame().tolerance_mm},
                  {"sample_bytes", distance.sample_bytes()},
                  {"smooth_bytes", distance.smooth_bytes()}};
  return summary;
}

Result<Summary> query_field(const QueryFieldJob& job, Progress& progress) {
  progress.begin_stage("read");
  LEFORT_TRY(const field::DistanceField distance, io::read_field(job.field));
  LEFORT_TRY(const std::vector<Vec3> points, io::read_points(job.points));
  if (job.smooth && !distance.is_smooth())
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} was built without --smooth; rebuild it with --smooth", job.field.string()));

  progress.begin_stage("query");
  std::string table =
      "x_mm,y_mm,z_mm,distance_mm,gradient_x,gradient_y,gradient_z,inside_band,zone\n";
  std::vector<field::FieldSample> samples(points.size());
  if (job.smooth) {
    std::vector<field::SmoothSample> smooth(points.size());
    distance.sample_smooth(points, smooth);
    for (std::size_t i = 0; i < points.size(); ++i)
      samples[i] = {smooth[i].zone, smooth[i].distance_mm, smooth[i].gradient_B};
  } else {
    distance.sample(points, samples);
  }
  Index in_band = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    table += row(points[i], samples[i].zone, samples[i].distance_mm, samples[i].gradient_B);
    in_band += samples[i].zone == field::Zone::kBand ? 1 : 0;
  }
  LEFORT_TRY_VOID(io::write_text(job.output, table));

  Summary summary;
  summary.text = fmt::format("{}: {} points, {} inside the band of {:.3f} mm", job.output.string(),
                             points.size(), in_band, distance.band_mm());
  summary.json = {{"output", job.output.string()},
                  {"points", points.size()},
                  {"points_inside_band", in_band},
                  {"band_mm", distance.band_mm()}};
  return summary;
}

Result<Summary> export_field(const ExportFieldJob& job, Progress& progress) {
  LEFORT_TRY(const std::optional<Box3> region, region_of(job.region_mm));
  progress.begin_stage("read");
  LEFORT_TRY(const field::DistanceField distance, io::read_field(job.field));
  LEFORT_TRY(
      const io::FieldExport done,
      io::export_field(job.output, distance, {.region_B = region, .every = job.every}, progress));
  const field::SampleCount& count = done.count;

  Summary summary;
  summary.text = fmt::format(
      "{}: {} x {} x {} samples {:.4f} mm apart, {} in the band of {:.3f} mm", job.output.string(),
      done.window.count[0], done.window.count[1], done.window.count[2],
      distance.cell_mm() * job.every, count.known, distance.band_mm());
  summary.json = {{"output", job.output.string()},
                  {"samples", done.window.count},
                  {"first_sample", done.window.first},
                  {"every", job.every},
                  {"spacing_mm", distance.cell_mm() * job.every},
                  {"band_mm", distance.band_mm()},
                  {"samples_in_band", count.known},
                  {"samples_outside", count.outside},
                  {"samples_inside", count.inside},
                  {"samples_unknown", count.unknown}};
  return summary;
}

}  // namespace lefort::pipeline
