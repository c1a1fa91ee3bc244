#include <lefort/field/query/slice_field.h>
#include <lefort/geometry/plane_section.h>
#include <lefort/io/field_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/field.h>
#include <lefort/pipeline/field/field_region.h>
#include <lefort/report/draw_slice.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lefort::pipeline {
namespace {

constexpr std::array<const char*, 3> kPlaneNames{"sagittal", "coronal", "axial"};

std::vector<geometry::Segment2> section_in(const field::FieldSlice& slice,
                                           const geometry::TriangleMesh& surface, int axis,
                                           double at_mm) {
  std::vector<geometry::Segment2> pieces;
  for (const auto& [from, to] : geometry::plane_section(surface, axis, at_mm))
    pieces.push_back({slice.pixel_at(from), slice.pixel_at(to)});
  return pieces;
}

Result<double> pixel_mm(const SliceFieldJob& job, const field::DistanceField& distance,
                        const field::SliceOptions& options) {
  if (job.every) return *job.every * distance.cell_mm();
  LEFORT_TRY(const Eigen::Vector2d extent_mm, field::slice_extent(distance.frame(), options));
  const double widest_px = field::kMaxSliceSide * std::min(1.0, extent_mm.x() / extent_mm.y());
  if (job.width_px > widest_px)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the width is {} pixels, what is shown is {:.4g} mm wide and {:.4g} mm "
                            "high and may be at most {:.0f} pixels wide",
                            job.width_px, extent_mm.x(), extent_mm.y(), std::floor(widest_px)));
  return extent_mm.x() / job.width_px;
}

std::string caption_of(const SliceFieldJob& job, const field::DistanceField& distance) {
  return fmt::format("{}: {} plane at {} = {:.6g} mm; cells of {:.3g} mm, band of {:.3g} mm{}{}",
                     job.field.filename().string(), kPlaneNames.at(std::size_t(job.axis)),
                     "xyz"[job.axis], job.at_mm, distance.cell_mm(), distance.band_mm(),
                     distance.frame().closed ? "" : ", open surface", job.smooth ? ", smooth" : "");
}

}  // namespace

Result<Summary> slice_field(const SliceFieldJob& job, Progress& progress) {
  if (job.output.extension() != ".png")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("picture {} must end in .png", job.output.string()));
  LEFORT_TRY(const std::optional<Box3> region, region_of(job.region_mm));
  progress.begin_stage("read");
  LEFORT_TRY(const field::DistanceField distance, io::read_field(job.field));
  geometry::TriangleMesh surface;
  if (job.mesh) {
    LEFORT_TRY(surface, io::read_surface(*job.mesh, progress));
  }

  progress.begin_stage("sample the field");
  field::SliceOptions options{
      .axis = job.axis, .at_mm = job.at_mm, .region_B = region, .smooth = job.smooth};
  LEFORT_TRY(options.pixel_mm, pixel_mm(job, distance, options));
  LEFORT_TRY(const field::FieldSlice slice, field::slice_field(distance, options));

  progress.begin_stage("draw");
  report::SliceDrawing drawing{.caption = caption_of(job, distance),
                               .columns = slice.columns,
                               .rows = slice.rows,
                               .distances_mm = slice.distances_mm,
                               .pixel_mm = slice.pixel_mm,
                               .right_L = slice.right_B,
                               .down_L = slice.down_B,
                               .band_mm = distance.band_mm()};
  drawing.outline = section_in(slice, surface, job.axis, job.at_mm);
  if (job.mesh) drawing.outline_name = fmt::format("surface {}", job.mesh->filename().string());
  LEFORT_TRY(const report::Picture picture, report::draw_slice(drawing));
  LEFORT_TRY(const std::string png, report::encode_png(picture));
  LEFORT_TRY_VOID(io::write_text(job.output, png));

  const field::SliceSummary found = field::summarize(slice);
  Summary summary;
  const bool closed = distance.frame().closed;  // An open surface has no inside beyond the band.
  summary.text = fmt::format(
      "{}: {} x {} pixels of {:.4g} mm, distances from {:.3f} to {:.3f} mm, zero along {:.1f} mm",
      job.output.string(), slice.columns, slice.rows, slice.pixel_mm, found.min_mm, found.max_mm,
      found.zero_line_mm);
  if (closed) summary.text += fmt::format(", {:.1f} mm2 inside", found.inside_mm2);
  summary.json = {{"output", job.output.string()},
                  {"plane", kPlaneNames.at(std::size_t(job.axis))},
                  {"axis", std::string(1, "xyz"[job.axis])},
                  {"at_mm", job.at_mm},
                  {"pixels", {slice.columns, slice.rows}},
                  {"pixel_mm", slice.pixel_mm},
                  {"band_mm", distance.band_mm()},
                  {"min_mm", found.min_mm},
                  {"max_mm", found.max_mm},
                  {"pixels_in_band", found.pixels.known},
                  {"pixels_outside", found.pixels.outside},
                  {"pixels_inside", found.pixels.inside},
                  {"pixels_unknown", found.pixels.unknown},
                  {"zero_line_mm", found.zero_line_mm}};
  summary.json["inside_mm2"] = closed ? nlohmann::json(found.inside_mm2) : nlohmann::json(nullptr);
  return summary;
}

}  // namespace lefort::pipeline
