/// \file
/// Slices of a field: distances on a plane, at the centers of square pixels.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/query/lattice_samples.h>

#include <optional>
#include <vector>

namespace lefort::field {

/// Plane and resolution of a slice.
struct SliceOptions {
  int axis = 2;        ///< Normal of the plane: 0 sagittal, 1 coronal, 2 axial.
  double at_mm = 0.0;  ///< Coordinate of the plane along the axis, in frame B.
  /// Region that is shown, by default the whole field; its extent along the normal is not used.
  std::optional<Box3> region_B{};
  double pixel_mm = 1.0;  ///< Edge of a pixel, > 0.
  bool smooth = false;    ///< Use the smooth interpolation (sample_smooth()).
};

/// Distances on a plane, rows from the top. Orientation as in radiology: the plane is seen from the
/// patient's feet (axial), front (coronal) or left (sagittal). The left of the picture is the
/// patient's right (axial, coronal) or front (sagittal).
struct FieldSlice {
  Vec3 corner_B;         ///< Upper left corner of the upper left pixel.
  Vec3 right_B, down_B;  ///< Unit, along axes.
  double pixel_mm = 0.0;
  int columns = 0, rows = 0;
  /// By row from the top, columns from the left; values as those of DistanceField::distances().
  std::vector<double> distances_mm{};

  /// Center of a pixel.
  [[nodiscard]] Vec3 place(double column, double row) const {
    return corner_B + (column + 0.5) * pixel_mm * right_B + (row + 0.5) * pixel_mm * down_B;
  }
  /// Column and row of a point in the plane; whole numbers are centers of pixels.
  [[nodiscard]] Eigen::Vector2d pixel_at(const Vec3& p_B) const {
    const Vec3 from_corner = (p_B - corner_B) / pixel_mm;
    return {from_corner.dot(right_B) - 0.5, from_corner.dot(down_B) - 0.5};
  }
};

/// Max pixels along an edge of a slice.
inline constexpr int kMaxSliceSide = 16'000;

/// Extent of a slice to the right and down [mm].
///
/// \param frame    lattice of the field.
/// \param options  plane and resolution.
/// \returns the extent; or kInvalidArgument if the axis is invalid, or the plane or the region does
///   not intersect the field.
[[nodiscard]] Result<Eigen::Vector2d> slice_extent(const FieldFrame& frame,
                                                   const SliceOptions& options);

/// Evaluates the field at every pixel.
///
/// \param field    to be evaluated.
/// \param options  plane and resolution.
/// \returns the slice; or kInvalidArgument as slice_extent(), if pixel_mm is not positive or gives
///   more than kMaxSliceSide pixels along an edge, or if `smooth` is set and the field is not
///   smooth.
[[nodiscard]] Result<FieldSlice> slice_field(const DistanceField& field,
                                             const SliceOptions& options);

/// Statistics of a slice.
struct SliceSummary {
  SampleCount pixels{};
  double inside_mm2 = 0.0;  ///< Area of pixels inside the surface, in and beyond the band.
  double min_mm = 0.0;      ///< Of distances in the band; 0 without any.
  double max_mm = 0.0;
  double zero_line_mm = 0.0;  ///< Length of the zero contour.
};

[[nodiscard]] SliceSummary summarize(const FieldSlice& slice);

}  // namespace lefort::field
