#include <lefort/core/parallel.h>
#include <lefort/dental/engrave_text.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::dental {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();
/// Half of the longest text along the front.
constexpr double kMaxHalfLength_mm = 18.0;
/// Parts of a column further behind its most anterior point are not its front.
constexpr double kFrontDepth_mm = 1.5;

/// The front of a body as seen from anterior.
struct Front {
  Index width = 0, height = 0;  ///< Columns along i and k.
  double spacing_mm = 1.0;
  std::vector<double> surface_mm;  ///< Along j, for each (i, k), i fastest; infinite: none.
  std::vector<double> outline_mm;  ///< The most anterior along each i, smoothed.
  std::vector<double> along_mm;    ///< Length of the outline from the middle, to the left.

  [[nodiscard]] double surface(Index i, Index k) const {
    return surface_mm[std::size_t(i + width * k)];
  }
  /// Ratio of depths along j and along the normal of the outline.
  [[nodiscard]] double stretch(Index i) const {
    const Index before = std::max<Index>(i - 1, 0), after = std::min(i + 1, width - 1);
    const double slope = (outline_mm[std::size_t(after)] - outline_mm[std::size_t(before)]) /
                         (spacing_mm * double(after - before));
    return std::isfinite(slope) ? std::hypot(1.0, slope) : 1.0;
  }
};

/// Where the level becomes positive along j.
double first_surface(const image::ScalarVolume& level, Index i, Index k) {
  const double h = level.grid.spacing_mm.y();
  for (Index j = 1; j < level.grid.size[1]; ++j) {
    const double before = level.at(i, j - 1, k), here = level.at(i, j, k);
    if (here > 0.0) return before > 0.0 ? 0.0 : h * (double(j) - here / (here - before));
  }
  return kNothing;
}

/// Mean of the finite values around each one.
std::vector<double> smoothed_line(const std::vector<double>& values, Index reach) {
  const Index size = std::ssize(values);
  std::vector<double> means(values.size(), kNothing);
  for (Index i = 0; i < size; ++i) {
    if (!std::isfinite(values[std::size_t(i)])) continue;
    double sum = 0.0, count = 0.0;
    for (Index n = std::max<Index>(i - reach, 0); n <= std::min(i + reach, size - 1); ++n)
      if (std::isfinite(values[std::size_t(n)])) {
        sum += values[std::size_t(n)];
        count += 1.0;
      }
    means[std::size_t(i)] = sum / count;
  }
  return means;
}

/// Length of the outline of the front from its middle, which is the most anterior part.
std::vector<double> lengths_along(const Front& front) {
  constexpr double kMiddle_mm = 0.5;
  const double first_mm = *std::min_element(front.outline_mm.begin(), front.outline_mm.end());
  double sum = 0.0, count = 0.0;
  for (Index i = 0; i < front.width; ++i)
    if (front.outline_mm[std::size_t(i)] <= first_mm + kMiddle_mm) {
      sum += double(i);
      count += 1.0;
    }
  std::vector<double> along(std::size_t(front.width), kNothing);
  auto middle = Index(std::lround(sum / count));
  for (Index i = 0; i < front.width; ++i)  // The closest column with a body.
    if (std::isfinite(front.outline_mm[std::size_t(i)]) &&
        (!std::isfinite(front.outline_mm[std::size_t(middle)]) ||
         std::abs(double(i) - sum / count) < std::abs(double(middle) - sum / count)))
      middle = i;
  for (const Index step : {Index(-1), Index(1)}) {
    double length = 0.0;
    for (Index i = middle; i >= 0 && i < front.width; i += step) {
      if (!std::isfinite(front.outline_mm[std::size_t(i)])) break;
      if (i != middle)
        length += std::hypot(front.spacing_mm, front.outline_mm[std::size_t(i)] -
                                                   front.outline_mm[std::size_t(i - step)]);
      along[std::size_t(i)] = double(step) * length;
    }
  }
  return along;
}

Result<Front> front_of(const image::ScalarVolume& level) {
  constexpr double kSmooth_mm = 1.0;
  Front front{level.grid.size[0], level.grid.size[2], level.grid.spacing_mm.x(), {}, {}, {}};
  front.surface_mm.assign(std::size_t(front.width * front.height), kNothing);
  parallel_for(front.width * front.height, [&](Index n) {
    front.surface_mm[std::size_t(n)] = first_surface(level, n % front.width, n / front.width);
  });
  std::vector<double> outline(std::size_t(front.width), kNothing);
  for (Index k = 0; k < front.height; ++k)
    for (Index i = 0; i < front.width; ++i)
      outline[std::size_t(i)] = std::min(outline[std::size_t(i)], front.surface(i, k));
  front.outline_mm = smoothed_line(outline, Index(std::lround(kSmooth_mm / front.spacing_mm)));
  if (std::none_of(outline.begin(), outline.end(), [](double y) { return std::isfinite(y); }))
    return fail(ErrorCode::kInvalidArgument, "there is no body to engrave");
  front.along_mm = lengths_along(front);
  return front;
}

/// Heights between which the front has space along a part of its outline; none if it is shorter.
struct Space {
  double low_mm = -kNothing, high_mm = kNothing;
};

Space space_at(const Front& front, double half_length_mm) {
  Space space;
  double right_mm = kNothing, left_mm = -kNothing;
  for (const double along_mm : front.along_mm)
    if (std::isfinite(along_mm)) {
      right_mm = std::min(right_mm, along_mm);
      left_mm = std::max(left_mm, along_mm);
    }
  if (!(right_mm <= -half_length_mm && left_mm >= half_length_mm)) return {0.0, -kNothing};
  for (Index i = 0; i < front.width; ++i) {
    if (!(std::abs(front.along_mm[std::size_t(i)]) <= half_length_mm)) continue;
    double low_mm = kNothing, high_mm = -kNothing;
    for (Index k = 0; k < front.height; ++k)
      if (front.surface(i, k) <=
          front.outline_mm[std::size_t(i)] + kFrontDepth_mm * front.stretch(i)) {
        low_mm = std::min(low_mm, front.spacing_mm * double(k));
        high_mm = std::max(high_mm, front.spacing_mm * double(k));
      }
    space.low_mm = std::max(space.low_mm, low_mm);
    space.high_mm = std::min(space.high_mm, high_mm);
  }
  return space;
}

/// Coverage at a position from the middle of the text [mm at its nominal size].
double coverage_at(const TextMask& text, double left_mm, double up_mm) {
  const double x = left_mm / text.pixel_mm + 0.5 * double(text.width) - 0.5;
  const double y = -up_mm / text.pixel_mm + 0.5 * double(text.height) - 0.5;
  const auto column = Index(std::floor(x)), row = Index(std::floor(y));
  const auto value = [&](Index c, Index r) {
    const bool is_in = c >= 0 && r >= 0 && c < text.width && r < text.height;
    return is_in ? double(text.coverage[std::size_t(c + text.width * r)]) : 0.0;
  };
  const double s = x - double(column), t = y - double(row);
  return (1.0 - t) * ((1.0 - s) * value(column, row) + s * value(column + 1, row)) +
         t * ((1.0 - s) * value(column, row + 1) + s * value(column + 1, row + 1));
}

/// Size of the letters relative to the nominal one, and the height of their middle.
struct Placement {
  double scale = 1.0, middle_mm = 0.0;
};

Result<Placement> place(const Front& front, const TextMask& text) {
  constexpr double kBorder_mm = 0.5, kMinScale = 0.6;
  const double length_mm = text.pixel_mm * double(text.width);
  const double height_mm = text.pixel_mm * double(text.height);
  Placement at{std::min(1.0, 2.0 * kMaxHalfLength_mm / length_mm), 0.0};
  Space space;
  for (int n = 0; n < 3; ++n) {  // Shorter letters have more space.
    space = space_at(front, 0.5 * at.scale * length_mm);
    const double free_mm = space.high_mm - space.low_mm - 2.0 * kBorder_mm;
    at.scale = std::min(at.scale, free_mm / height_mm);
  }
  if (!(at.scale >= kMinScale))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the text would be {:.0f} % of its size, must be {:.0f} % or more: "
                            "shorten it, or the front of the splint is too low",
                            100.0 * std::max(at.scale, 0.0), 100.0 * kMinScale));
  at.middle_mm = 0.5 * (space.low_mm + space.high_mm);
  return at;
}

}  // namespace

Result<void> engrave_front(image::ScalarVolume& level, const TextMask& text, double depth_mm) {
  if (text.width == 0 || text.height == 0) return {};
  LEFORT_TRY(const Front front, front_of(level));
  LEFORT_TRY(const Placement at, place(front, text));
  const image::Grid& grid = level.grid;
  // Level of the letters: half of the width over which the coverage changes.
  const double edge_mm = std::max(at.scale * text.pixel_mm, grid.spacing_mm.x());
  parallel_for(grid.size[0] * grid.size[2], [&](Index n) {
    const Index i = n % grid.size[0], k = n / grid.size[0];
    const double surface_mm = front.surface(i, k), along_mm = front.along_mm[std::size_t(i)];
    const double reach_mm =
        front.outline_mm[std::size_t(i)] + 2.0 * kFrontDepth_mm * front.stretch(i);
    if (!std::isfinite(along_mm) || !(surface_mm <= reach_mm)) return;
    const double up_mm = grid.spacing_mm.z() * double(k) - at.middle_mm;
    const double coverage = coverage_at(text, along_mm / at.scale, up_mm / at.scale);
    if (coverage <= 0.0) return;
    const double letters = edge_mm * (coverage - 0.5);
    const double stretch = front.stretch(i);
    for (Index j = 0; j < grid.size[1]; ++j) {
      const double behind_mm = (grid.spacing_mm.y() * double(j) - surface_mm) / stretch;
      const double engraved = std::min(letters, depth_mm - behind_mm);
      level.at(i, j, k) = std::min(level.at(i, j, k), float(-engraved));
    }
  });
  return {};
}

}  // namespace lefort::dental
