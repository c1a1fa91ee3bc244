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

}  // namespace

image::ScalarVolume distance_to(const Mask& mask) {
  const image::Grid& grid = mask.grid;
  image::ScalarVolume distance{grid, std::vector<float>(mask.values.size())};
  std::transform(mask.values.begin(), mask.values.end(), distance.values.begin(),
                 [](std::uint8_t set) { return set != 0 ? 0.0F : kNone; });
  for (std::size_t axis = 0; axis < 3; ++axis)
    for_each_line(grid, axis, [&](Index start, Index stride) {
      thread_local Line line;
      lower_envelope(distance.values.data() + start, grid.size[axis], stride,
                     grid.spacing_mm[Index(axis)], line);
    });
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
