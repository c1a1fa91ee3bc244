#include <lefort/core/check.h>
#include <lefort/geometry/iso_lines.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace lefort::geometry {

namespace {

// Corners of a square, and its sides:
//
//   3 --2-- 2
//   |       |     y upwards
//   3       1
//   |       |
//   0 --0-- 1
constexpr std::array<std::array<int, 2>, 4> kCorner = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

struct Square {
  Eigen::Vector2d low;
  std::array<double, 4> above;  ///< Value minus level, at the corners.

  /// Point where side `s` crosses the level, computed from the high to the low corner, so that the
  /// neighboring square computes the same bits. \pre one corner of the side is high and one low.
  [[nodiscard]] Eigen::Vector2d crossing(std::size_t s) const {
    const std::size_t high = is_high(s) ? s : (s + 1) % 4, to = is_high(s) ? (s + 1) % 4 : s;
    const Eigen::Vector2d a(kCorner[high][0], kCorner[high][1]), b(kCorner[to][0], kCorner[to][1]);
    return low + a + above[high] / (above[high] - above[to]) * (b - a);
  }
  [[nodiscard]] bool is_high(std::size_t corner) const { return above[corner] >= 0.0; }
};

void add_lines(const Square& square, std::vector<Segment2>& lines) {
  // Counter-clockwise, a line starts on a side that falls (from high to low) and ends on the next
  // side that rises; at a saddle with connected high corners on the previous one. So higher values
  // are to its left.
  std::array<std::size_t, 2> falls{}, rises{};
  std::size_t fall_count = 0, rise_count = 0;
  for (std::size_t s = 0; s < 4; ++s) {
    const bool from = square.is_high(s), to = square.is_high((s + 1) % 4);
    if (from && !to) falls[fall_count++] = s;
    if (!from && to) rises[rise_count++] = s;
  }
  if (fall_count == 0) return;
  if (fall_count == 1) {
    lines.push_back({square.crossing(falls[0]), square.crossing(rises[0])});
    return;
  }
  const double middle = square.above[0] + square.above[1] + square.above[2] + square.above[3];
  for (const std::size_t fall : falls) {
    // If the high corners are connected, each line cuts off the low corner after its falling side;
    // else the high corner before it.
    const std::size_t rise = middle >= 0.0 ? (fall + 1) % 4 : (fall + 3) % 4;
    lines.push_back({square.crossing(fall), square.crossing(rise)});
  }
}

}  // namespace

std::vector<Segment2> iso_lines(std::span<const double> values, int columns, double level) {
  LEFORT_CHECK(columns > 0 && values.size() % std::size_t(columns) == 0);
  const auto width = std::size_t(columns), rows = values.size() / width;
  std::vector<Segment2> lines;
  for (std::size_t y = 0; y + 1 < rows; ++y)
    for (std::size_t x = 0; x + 1 < width; ++x) {
      Square square{Eigen::Vector2d(double(x), double(y)), {}};
      bool finite = true;
      for (std::size_t c = 0; c < 4; ++c) {
        const double value =
            values[(y + std::size_t(kCorner[c][1])) * width + x + std::size_t(kCorner[c][0])];
        square.above[c] = value - level;
        finite = finite && std::isfinite(value);
      }
      if (finite) add_lines(square, lines);
    }
  return lines;
}

double total_length(std::span<const Segment2> pieces) {
  double sum = 0.0;
  for (const Segment2& piece : pieces) sum += piece.length();
  return sum;
}

}  // namespace lefort::geometry
