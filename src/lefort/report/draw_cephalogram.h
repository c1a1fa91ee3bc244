/// \file
/// Draws a radiograph with tracings and landmarks.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/iso_lines.h>
#include <lefort/report/color_map.h>
#include <lefort/report/picture.h>

#include <string>
#include <vector>

namespace lefort::report {

/// Lines with one entry in the legend. Coordinates are pixels: x from the left, y from the top.
struct Tracing {
  std::string name{};
  Rgb color{};
  std::vector<geometry::Segment2> lines{};
};

struct TracedPoint {
  std::string name{};
  Rgb color{};
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
};

struct CephalogramDrawing {
  std::string caption{};
  std::string scale_note{};  ///< Projection and magnification.
  int columns = 0, rows = 0;
  /// Thickness of water [mm], rows from the top. Empty: tracings on white paper.
  std::vector<double> water_mm{};
  double pixel_mm = 1.0;
  std::vector<Tracing> tracings{};
  std::vector<TracedPoint> points{};
};

/// Gray is proportional to the thickness to the power 0.6, from 0 (black) to its 99.8 % quantile
/// (white), so that the profile of the skin is visible.
///
/// \param drawing  what to draw.
/// \returns the picture, with legend, scale bar and kNotForClinicalUse below; or kInvalidArgument
///   if sizes are inconsistent or the picture would be larger than kMaxPictureSide.
[[nodiscard]] Result<Picture> draw_cephalogram(const CephalogramDrawing& drawing);

}  // namespace lefort::report
