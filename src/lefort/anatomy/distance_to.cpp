#include <lefort/anatomy/voxel_mask.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lefort::anatomy {
namespace {

constexpr float kEmptySet_mm = 1e6F;
constexpr float kNone = std::numeric_limits<float>::infinity();

/// Work space for one line of voxels.
struct Line {
  std::vector<float> squared;  ///< Squared distance along the axes already processed.
  std::vector<Index> apex;     ///< Voxels whose parabolas form the lower envelope ...
  std::vector<double> from;    ///< ... and the position where each parabola begins.
};

/// Sets values[i * stride] to the minimum over j of values[j * stride] + (spacing (i - j))^2: the
/// lower envelope of the parabolas of all j (Felzenszwalb and Huttenlocher 2012, algorithm 1).
void lower_envelope(float* values, Index size, Index stride, double spacing_mm, Line& line) {
  const double square_mm2 = spacing_mm * spacing_mm;
  line.squared.resize(std::size_t(size));
  line.apex.resize(std::size_t(size));
  line.from.resize(std::size_t(size));
  Index last = -1;
  for (Index j = 0; j < size; ++j) {
    const float squared = values[j * stride];
    line.squared[std::size_t(j)] = squared;
    if (squared == kNone) continue;
    double from = -std::numeric_limits<double>::infinity();
    while (last >= 0) {
      const Index i = line.apex[std::size_t(last)];
      from = 0.5 * ((double(squared) - double(line.squared[std::size_t(i)])) /
                        (square_mm2 * double(j - i)) +
                    double(j + i));
      if (from > line.from[std::size_t(last)]) break;
      --last;
      from = -std::numeric_limits<double>::infinity();
    }
    ++last;
    line.apex[std::size_t(last)] = j;
    line.from[std::size_t(last)] = from;
  }
  if (last < 0) return;
  Index piece = 0;
  for (Index i = 0; i < size; ++i) {
    while (piece < last && line.from[std::size_t(piece) + 1] < double(i)) ++piece;
    const Index j = line.apex[std::size_t(piece)];
    const double steps = double(i - j);
    values[i * stride] = float(square_mm2 * steps * steps + double(line.squared[std::size_t(j)]));
  }
}

/// As lower_envelope() for a line along which nothing was processed, where values are 0 or kNone.
void squared_along(float* values, Index size, double spacing_mm) {
  const double square_mm2 = spacing_mm * spacing_mm;
  const auto sweep = [&](Index first, Index step) {
    Index steps = -1;  // From the last voxel of the set, -1 before it.
    for (Index n = 0, i = first; n < size; ++n, i += step) {
      if (values[i] == 0.0F)
        steps = 0;
      else if (steps >= 0)
        values[i] = std::min(values[i], float(square_mm2 * double(steps + 1) * double(steps + 1)));
      if (steps >= 0 && values[i] != 0.0F) ++steps;
    }
  };
  sweep(0, 1);
  sweep(size - 1, -1);
}

/// As lower_envelope() for `rows` rows of `columns` values at the same time, limited to parabolas
/// whose apex is at most `reach` rows away.
void lower_envelope_within(float* values, Index rows, Index row_stride, Index columns,
                           double spacing_mm, Index reach) {
  const double square_mm2 = spacing_mm * spacing_mm;
  thread_local std::vector<float> before;
  thread_local std::vector<double> least;
  before.resize(std::size_t(rows * columns));
  least.resize(std::size_t(columns));
  for (Index row = 0; row < rows; ++row)
    std::copy_n(values + row * row_stride, columns, before.begin() + row * columns);
  for (Index row = 0; row < rows; ++row) {
    std::fill(least.begin(), least.end(), double(kNone));
    const Index last = std::min(rows - 1, row + reach);
    for (Index apex = std::max(Index(0), row - reach); apex <= last; ++apex) {
      const double steps = double(row - apex), along = square_mm2 * steps * steps;
      const float* const from = before.data() + apex * columns;
      double* const to = least.data();
      for (Index i = 0; i < columns; ++i) to[i] = std::min(to[i], along + double(from[i]));
    }
    float* const to = values + row * row_stride;
    for (Index i = 0; i < columns; ++i) to[i] = float(least[std::size_t(i)]);
  }
}

/// Processes axis 1 or 2.
void process(image::ScalarVolume& squared, std::size_t axis, double max_mm) {
  constexpr double kMaxReach = 12.0;  // Voxels up to which trying all apexes is faster.
  const image::Grid& grid = squared.grid;
  const double spacing_mm = grid.spacing_mm[Index(axis)];
  const double reach = std::floor(max_mm / spacing_mm) + 1.0;
  const Index columns = grid.size[0], slice = grid.size[0] * grid.size[1];
  if (!(reach <= kMaxReach)) {
    for_each_line(grid, axis, [&](Index start, Index stride) {
      thread_local Line line;
      lower_envelope(squared.values.data() + start, grid.size[axis], stride, spacing_mm, line);
    });
    return;
  }
  const std::size_t other = axis == 1 ? 2 : 1;
  const Index stride = axis == 1 ? columns : slice, other_stride = axis == 1 ? slice : columns;
  parallel_for(
      grid.size[other],
      [&](Index n) {
        lower_envelope_within(squared.values.data() + n * other_stride, grid.size[axis], stride,
                              columns, spacing_mm, Index(reach));
      },
      1);
}

}  // namespace

image::ScalarVolume distance_to(const Mask& mask, double max_mm) {
  const image::Grid& grid = mask.grid;
  image::ScalarVolume distance{grid, std::vector<float>(mask.values.size())};
  for_each_line(grid, 0, [&](Index start, Index) {
    float* const line = distance.values.data() + start;
    std::transform(mask.values.begin() + start, mask.values.begin() + start + grid.size[0], line,
                   [](std::uint8_t set) { return set != 0 ? 0.0F : kNone; });
    squared_along(line, grid.size[0], grid.spacing_mm.x());
  });
  for (const std::size_t axis : {1U, 2U}) process(distance, axis, max_mm);
  parallel_for(
      grid.voxel_count(),
      [&](Index v) {
        float& value = distance.values[std::size_t(v)];
        value = value == kNone ? kEmptySet_mm : std::sqrt(value);
      },
      65536);
  return distance;
}

}  // namespace lefort::anatomy
