/// \file
/// Draws a plane section of a distance field, with its zero, its contour lines and unsampled
/// regions.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/iso_lines.h>
#include <lefort/report/picture.h>

#include <string>
#include <vector>

namespace lefort::report {

struct SliceDrawing {
  std::string caption{};
  int columns = 0, rows = 0;
  /// Rows from the top [mm], negative inside; +infinity outside beyond the band, -infinity inside
  /// beyond it, NaN where unknown.
  std::vector<double> distances_mm{};
  double pixel_mm = 1.0;        ///< Side of a pixel.
  Vec3 right_L{1.0, 0.0, 0.0};  ///< Direction towards the right of the picture.
  Vec3 down_L{0.0, 1.0, 0.0};   ///< Direction towards the bottom of the picture.
  double band_mm = 1.0;         ///< Ends of the color scale, > 0.
  double step_mm = 0.0;         ///< Between contour lines; 0: a round number.
  /// The surface in the plane, in columns and rows; integers are centers of pixels.
  std::vector<geometry::Segment2> outline{};
  std::string outline_name{};  ///< For the legend.
};

/// Distances are blue inside and red outside, with a thick line at zero and thin ones at multiples
/// of the step. Points beyond the band are gray, darker inside; unknown ones are hatched. Letters
/// at the four edges name the patient's sides; legend, scale bar and kNotForClinicalUse are below.
///
/// \param drawing  the distances and how to draw them.
/// \returns the picture; or kInvalidArgument if the sizes are inconsistent, a length is not
///   positive, a step is less than a thousandth of the band, or the picture would be larger than
///   kMaxPictureSide.
[[nodiscard]] Result<Picture> draw_slice(const SliceDrawing& drawing);

}  // namespace lefort::report
