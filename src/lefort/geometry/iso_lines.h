/// \file
/// Contour lines of a function on a plane grid.
#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

namespace lefort::geometry {

/// A line segment in the plane.
struct Segment2 {
  Eigen::Vector2d from, to;

  [[nodiscard]] double length() const { return (to - from).norm(); }
};

/// Marching squares: contour of a function that is linear along the sides of each square of four
/// values. At a saddle the mean of the four values decides which corners are connected.
///
/// \param values   x fastest, `columns` per row; the value at (column, row). Squares with a value
///   that is not finite give no line.
/// \param columns  length of a row.
/// \param level    value of the contour.
/// \returns segments in the coordinates (column, row), higher values to their left (y upward).
[[nodiscard]] std::vector<Segment2> iso_lines(std::span<const double> values, int columns,
                                              double level);

/// Sum of the lengths of all segments.
[[nodiscard]] double total_length(std::span<const Segment2> pieces);

}  // namespace lefort::geometry
