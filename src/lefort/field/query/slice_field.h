/// \file
/// A field on a plane, as a picture of it needs: distances at the middle of square pixels.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/query/lattice_samples.h>

#include <optional>
#include <vector>

namespace lefort::field {

struct SliceOptions {
  int axis = 2;                    ///< Across the plane: 0 sagittal, 1 coronal, 2 axial.
  double at_mm = 0.0;              ///< Coordinate of the plane along the axis.
  std::optional<Box3> region_B{};  ///< What is shown; its extent along the axis does not matter.
  double pixel_mm = 1.0;           ///< Side of a pixel, > 0.
  bool smooth = false;             ///< The differentiable reconstruction.
};

/// Distances on a plane, rows from the top. Sides are as in radiology: seen from the patient's feet
/// (axial), front (coronal) and left (sagittal), so that the patient's right, right and front are
/// on the left of the picture.
struct FieldSlice {
  Vec3 corner_B;         ///< Upper left corner of the upper left pixel.
  Vec3 right_B, down_B;  ///< Unit, along axes.
  double pixel_mm = 0.0;
  int columns = 0, rows = 0;
  std::vector<double> distances_mm{};  ///< +-infinity beyond the band, NaN where not known.

  /// Middle of a pixel.
  [[nodiscard]] Vec3 place(double column, double row) const {
    return corner_B + (column + 0.5) * pixel_mm * right_B + (row + 0.5) * pixel_mm * down_B;
  }
  /// Column and row of a point of the plane; whole numbers are middles of pixels.
  [[nodiscard]] Eigen::Vector2d pixel_at(const Vec3& p_B) const {
    const Vec3 from_corner = (p_B - corner_B) / pixel_mm;
    return {from_corner.dot(right_B) - 0.5, from_corner.dot(down_B) - 0.5};
  }
};

inline constexpr int kMaxSliceSide = 16'000;

/// Extent of what a slice shows, to the right and down [mm].
///
/// \returns kInvalidArgument if the axis is none, or the plane or the region misses the field.
[[nodiscard]] Result<Eigen::Vector2d> slice_extent(const FieldFrame& frame,
                                                   const SliceOptions& options);

/// Asks the field at every pixel.
///
/// \returns as slice_extent(); kInvalidArgument if the pixels are more than kMaxSliceSide along a
///   side, or `smooth` is asked of a field without.
[[nodiscard]] Result<FieldSlice> slice_field(const DistanceField& field,
                                             const SliceOptions& options);

/// A slice in numbers.
struct SliceSummary {
  SampleCount pixels{};
  double inside_mm2 = 0.0;  ///< Of pixels inside, within the band or beyond it if that is known.
  double min_mm = 0.0;      ///< Of the distances in the band; 0 if there are none.
  double max_mm = 0.0;
  double zero_line_mm = 0.0;  ///< Length of the line where the distance is zero.
};

[[nodiscard]] SliceSummary summarize(const FieldSlice& slice);

}  // namespace lefort::field
