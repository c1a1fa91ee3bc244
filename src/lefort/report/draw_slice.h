/// \file
/// A distance field on a plane, drawn so that its zero, its slope and its gaps can be seen.
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
  /// Rows from the top [mm], negative inside; +infinity beyond the band outside, -infinity inside,
  /// NaN where not known.
  std::vector<double> distances_mm{};
  double pixel_mm = 1.0;        ///< Side of a pixel.
  Vec3 right_L{1.0, 0.0, 0.0};  ///< Where the picture's right and bottom lie.
  Vec3 down_L{0.0, 1.0, 0.0};
  double band_mm = 1.0;  ///< Ends of the colors, > 0.
  double step_mm = 0.0;  ///< Between lines of equal distance; 0 chooses a round one.
  /// The surface in the plane, in columns and rows; whole numbers are middles of pixels.
  std::vector<geometry::Segment2> outline{};
  std::string outline_name{};  ///< For the legend.
};

/// Distances in colors, blue inside and red outside, with a thick line where they are zero and
/// thin ones at multiples of the step. What is beyond the band is gray, darker inside; what is not
/// known is hatched. Around it the letters of the patient's sides, below it the legend, a scale and
/// kNotForClinicalUse.
///
/// \returns kInvalidArgument if the numbers do not fit each other, a length is not positive, or the
///   picture gets larger than kMaxPictureSide.
[[nodiscard]] Result<Picture> draw_slice(const SliceDrawing& drawing);

}  // namespace lefort::report
