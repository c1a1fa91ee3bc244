#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/image/resample_slices.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace lefort::image {
namespace {

// Range of a 12-bit CT [HU]; cubic convolution overshoots next to air and metal.
constexpr double kMinHu = -1024.0;
constexpr double kMaxHu = 3071.0;

/// Weights of the pixels at -1, 0, 1, 2 for a point at `t` between 0 and 1 (\cite keys1981, a =
/// -1/2).
std::array<double, 4> keys_weights(double t) {
  return {t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (-2.5 + 1.5 * t),
          t * (0.5 + t * (2.0 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)};
}

/// Interpolates a line of pixels at n + `shift`; NaN outside of the line.
void shifted_line(std::span<const double> line, double shift, std::span<double> target) {
  const double shift_floor = std::floor(shift);
  const auto weights = keys_weights(shift - shift_floor);
  const auto last = std::ssize(line) - 1;
  for (Index n = 0; n < std::ssize(target); ++n) {
    const Index at = n + Index(shift_floor);
    const double position = double(n) + shift;
    // The outermost pixel, too, extends half a spacing from its center.
    if (position < -0.5 || position > double(last) + 0.5) {
      target[std::size_t(n)] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    double sum = 0.0;
    for (Index tap = 0; tap < 4; ++tap)
      sum +=
          weights[std::size_t(tap)] * line[std::size_t(std::clamp(at + tap - 1, Index{0}, last))];
    target[std::size_t(n)] = sum;
  }
}

/// Slice k of `slices`, interpolated at the pixels of `grid`.
std::vector<double> shifted_slice(const CtVolume& slices, Index k, const Vec3& origin_L,
                                  const Grid& grid) {
  const Vec3 shift =
      (grid.direction.transpose() * (grid.origin_L - origin_L)).cwiseQuotient(grid.spacing_mm);
  const auto [columns, rows, count] = slices.grid.size;
  const Index wide = grid.size[0], high = grid.size[1];
  std::vector<double> along_i(std::size_t(wide * rows));
  std::vector<double> line(static_cast<std::size_t>(std::max(columns, rows)));
  for (Index j = 0; j < rows; ++j) {
    for (Index i = 0; i < columns; ++i) line[std::size_t(i)] = slices.at(i, j, k);
    shifted_line(std::span(line).first(std::size_t(columns)), shift.x(),
                 std::span(along_i).subspan(std::size_t(j * wide), std::size_t(wide)));
  }
  std::vector<double> values(std::size_t(wide * high));
  std::vector<double> target(static_cast<std::size_t>(high));
  for (Index i = 0; i < wide; ++i) {
    for (Index j = 0; j < rows; ++j) line[std::size_t(j)] = along_i[std::size_t(i + j * wide)];
    shifted_line(std::span(line).first(std::size_t(rows)), shift.y(), target);
    for (Index j = 0; j < high; ++j) values[std::size_t(i + j * wide)] = target[std::size_t(j)];
  }
  return values;
}

}  // namespace

Grid regular_grid(const Grid& slice, std::span<const Vec3> origins_L, double first_height_mm,
                  double distance_mm, Index count) {
  LEFORT_CHECK(!origins_L.empty());
  Grid grid = slice;
  grid.size[2] = count;
  grid.spacing_mm.z() = distance_mm;
  for (Index axis = 0; axis < 2; ++axis) {
    const Vec3 unit = slice.direction.col(axis);
    double low = unit.dot(origins_L.front()), high = low;
    for (const Vec3& origin_L : origins_L) {
      low = std::min(low, unit.dot(origin_L));
      high = std::max(high, unit.dot(origin_L));
    }
    // Less than a thousandth of a pixel is rounding and needs no further column.
    const auto more = Index(std::ceil((high - low) / slice.spacing_mm[axis] - 1e-3));
    grid.size[std::size_t(axis)] += std::max(more, Index{0});
    grid.origin_L += (low - unit.dot(grid.origin_L)) * unit;
  }
  const Vec3 normal = slice.direction.col(2);
  grid.origin_L += (first_height_mm - normal.dot(grid.origin_L)) * normal;
  return grid;
}

CtVolume resample_slices(const CtVolume& slices, std::span<const Vec3> origins_L, const Grid& grid,
                         std::int16_t outside) {
  LEFORT_CHECK(std::ssize(origins_L) == slices.grid.size[2] && origins_L.size() >= 2);
  LEFORT_CHECK(std::ssize(slices.values) == slices.grid.voxel_count());
  const Vec3 normal = grid.direction.col(2);
  std::vector<double> heights_mm;
  for (const Vec3& origin_L : origins_L) heights_mm.push_back(normal.dot(origin_L));
  CtVolume resampled{grid, std::vector<std::int16_t>(std::size_t(grid.voxel_count()))};
  const Index per_slice = grid.size[0] * grid.size[1];
  parallel_for(
      grid.size[2],
      [&](Index k) {
        const double height_mm =
            normal.dot(grid.origin_L) + grid.spacing_mm.z() * static_cast<double>(k);
        const auto above =
            std::upper_bound(heights_mm.begin() + 1, heights_mm.end() - 1, height_mm);
        const auto upper = Index(above - heights_mm.begin());
        const double low_mm = heights_mm[std::size_t(upper - 1)];
        // Within rounding of the height of a slice, that slice is used alone.
        constexpr double kRounding = 1e-6;
        double fraction = std::clamp((height_mm - low_mm) / (*above - low_mm), 0.0, 1.0);
        if (fraction < kRounding) fraction = 0.0;
        if (fraction > 1.0 - kRounding) fraction = 1.0;
        std::vector<double> values(std::size_t(per_slice), 0.0);
        for (const auto& [slice, weight] :
             {std::pair(upper - 1, 1.0 - fraction), std::pair(upper, fraction)}) {
          if (weight == 0.0) continue;
          const std::vector<double> of_slice =
              shifted_slice(slices, slice, origins_L[std::size_t(slice)], grid);
          for (std::size_t n = 0; n < values.size(); ++n) values[n] += weight * of_slice[n];
        }
        for (std::size_t n = 0; n < values.size(); ++n)
          resampled.values[std::size_t(k * per_slice) + n] =
              std::isnan(values[n])
                  ? outside
                  : static_cast<std::int16_t>(std::lround(std::clamp(values[n], kMinHu, kMaxHu)));
      },
      1);
  return resampled;
}

}  // namespace lefort::image
