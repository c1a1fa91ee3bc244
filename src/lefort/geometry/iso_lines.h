/// \file
/// Lines of equal value on a grid in the plane.
#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

namespace lefort::geometry {

/// A piece of a line in a plane.
struct Segment2 {
  Eigen::Vector2d from, to;

  [[nodiscard]] double length() const { return (to - from).norm(); }
};

/// Marching squares: where a function, linear along the sides of each square of four values, takes
/// a value. At a saddle the mean of the four decides which corners hang together.
///
/// \param values  x fastest, `columns` in a row; the value at (column, row). Squares with one that
///   is not finite give no line.
/// \returns pieces in the coordinates (column, row), higher values to their left (with y upwards).
[[nodiscard]] std::vector<Segment2> iso_lines(std::span<const double> values, int columns,
                                              double level);

/// Of all pieces together.
[[nodiscard]] double total_length(std::span<const Segment2> pieces);

}  // namespace lefort::geometry
