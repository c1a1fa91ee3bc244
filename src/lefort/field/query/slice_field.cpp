#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/field/query/slice_field.h>
#include <lefort/geometry/iso_lines.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lefort::field {

namespace {

/// Axes of the picture of a slice.
struct Sides {
  Vec3 right_B, down_B;
};
Sides sides_of(int axis) {
  if (axis == 0) return {Vec3::UnitY(), -Vec3::UnitZ()};
  if (axis == 1) return {Vec3::UnitX(), -Vec3::UnitZ()};
  return {Vec3::UnitX(), Vec3::UnitY()};
}

Box3 cube_of(const FieldFrame& frame) {
  return {frame.origin_B, frame.origin_B + Vec3::Constant(frame.cell_mm * frame.resolution)};
}

Result<Box3> shown_box(const FieldFrame& frame, const SliceOptions& options) {
  if (options.axis < 0 || options.axis > 2)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("axis is {}, it must be 0, 1 or 2", options.axis));
  const Box3 cube = cube_of(frame);
  const double low = cube.min()[options.axis], high = cube.max()[options.axis];
  if (!(options.at_mm >= low && options.at_mm <= high))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the plane lies at {} = {} mm, it must intersect the field, which extends "
                    "from {:.6g} to {:.6g} mm",
                    "xyz"[options.axis], options.at_mm, low, high));
  Box3 shown = options.region_B ? options.region_B->intersection(cube) : cube;
  shown.min()[options.axis] = shown.max()[options.axis] = options.at_mm;
  for (int k = 0; k < 3; ++k)
    if (k != options.axis && !(shown.sizes()[k] > 0.0))
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("region does not overlap the field along {}, which extends from {:.6g} to "
                      "{:.6g} mm",
                      "xyz"[k], cube.min()[k], cube.max()[k]));
  return shown;
}

double distance_of(Zone zone, double distance_mm) {
  return zone == Zone::kBand ? distance_mm : double(zone_value(zone));
}

}  // namespace

Result<Eigen::Vector2d> slice_extent(const FieldFrame& frame, const SliceOptions& options) {
  LEFORT_TRY(const Box3 shown, shown_box(frame, options));
  const Sides sides = sides_of(options.axis);
  return Eigen::Vector2d(sides.right_B.cwiseAbs().dot(shown.sizes()),
                         sides.down_B.cwiseAbs().dot(shown.sizes()));
}

Result<FieldSlice> slice_field(const DistanceField& field, const SliceOptions& options) {
  if (options.smooth && !field.is_smooth())
    return fail(ErrorCode::kInvalidArgument,
                "the field has no smooth reconstruction; build it with one");
  LEFORT_TRY(const Box3 shown, shown_box(field.frame(), options));
  LEFORT_TRY(const Eigen::Vector2d extent_mm, slice_extent(field.frame(), options));
  if (!(options.pixel_mm > 0.0 && extent_mm.maxCoeff() <= kMaxSliceSide * options.pixel_mm))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("pixels are {} mm wide, they must be at least {:.3g} mm",
                            options.pixel_mm, extent_mm.maxCoeff() / kMaxSliceSide));
  const Sides sides = sides_of(options.axis);
  FieldSlice slice{.corner_B = shown.min(),
                   .right_B = sides.right_B,
                   .down_B = sides.down_B,
                   .pixel_mm = options.pixel_mm,
                   .columns = std::max(1, int(std::lround(extent_mm.x() / options.pixel_mm))),
                   .rows = std::max(1, int(std::lround(extent_mm.y() / options.pixel_mm)))};
  for (int k = 0; k < 3; ++k)
    if (slice.down_B[k] < 0.0) slice.corner_B[k] = shown.max()[k];

  const auto columns = std::size_t(slice.columns);
  slice.distances_mm.resize(columns * std::size_t(slice.rows));
  parallel_for(
      slice.rows,
      [&](Index row) {
        for (std::size_t column = 0; column < columns; ++column) {
          const Vec3 p = slice.place(double(column), double(row));
          double& distance = slice.distances_mm[std::size_t(row) * columns + column];
          if (options.smooth) {
            const SmoothSample sample = field.sample_smooth(p);
            distance = distance_of(sample.zone, sample.distance_mm);
          } else {
            const FieldSample sample = field.sample(p);
            distance = distance_of(sample.zone, sample.distance_mm);
          }
        }
      },
      16);
  return slice;
}

SliceSummary summarize(const FieldSlice& slice) {
  SliceSummary summary;
  Index inside = 0;
  for (const double d : slice.distances_mm) {
    summary.pixels.add(float(d));
    inside += d < 0.0 ? 1 : 0;
    if (!std::isfinite(d)) continue;
    const bool first = summary.pixels.known == 1;
    summary.min_mm = first ? d : std::min(summary.min_mm, d);
    summary.max_mm = first ? d : std::max(summary.max_mm, d);
  }
  summary.inside_mm2 = double(inside) * slice.pixel_mm * slice.pixel_mm;
  summary.zero_line_mm = slice.pixel_mm * geometry::total_length(geometry::iso_lines(
                                              slice.distances_mm, slice.columns, 0.0));
  return summary;
}

}  // namespace lefort::field
