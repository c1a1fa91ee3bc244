#include <lefort/plan/internal/facial_cavities.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace lefort::plan::internal {
namespace {

constexpr double kRowStep_mm = 1.0, kViewHalfWidth_mm = 65.0, kViewHalfHeight_mm = 150.0;
constexpr int kViewHalf = int(kViewHalfWidth_mm / kRowStep_mm);

/// The depth y of the skull along one row, from the right to the left; infinite without bone.
std::vector<double> depths_of(const geometry::SurfaceCrossings& front, double z_mm) {
  std::vector<double> depths;
  for (int i = -kViewHalf; i <= kViewHalf; ++i) {
    const auto p = front.first({double(i) * kRowStep_mm, 0.0, z_mm});
    depths.push_back(p ? p->y() : std::numeric_limits<double>::infinity());
  }
  return depths;
}

/// \param within_mm  distance within which bone on both sides is searched.
/// \returns for each point, whether bone on both sides lies `depth_mm` or more in front of it.
std::vector<bool> cavities_in(std::span<const double> depths, double depth_mm, double within_mm) {
  const auto count = std::ptrdiff_t(depths.size()), reach = std::ptrdiff_t(within_mm / kRowStep_mm);
  std::vector<bool> is_cavity;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto begin = depths.begin(), at = begin + i;
    const double right = *std::min_element(begin + std::max<std::ptrdiff_t>(0, i - reach), at + 1);
    const double left = *std::min_element(at, begin + std::min(count, i + reach + 1));
    is_cavity.push_back(depths[std::size_t(i)] > std::max(right, left) + depth_mm);
  }
  return is_cavity;
}

/// The cavity of a row between two columns.
struct RowCavity {
  Index count = 0;
  double sum_x_mm = 0.0;
};

RowCavity count_between(const std::vector<bool>& is_cavity, double from_mm, double to_mm) {
  RowCavity found;
  for (int i = -kViewHalf; i <= kViewHalf; ++i) {
    const double x_mm = double(i) * kRowStep_mm;
    if (x_mm < from_mm || x_mm > to_mm || !is_cavity[std::size_t(i + kViewHalf)]) continue;
    ++found.count;
    found.sum_x_mm += x_mm;
  }
  return found;
}

/// The run of rows with the largest sum of sizes; gaps of up to two rows are allowed.
struct Run {
  std::size_t begin = 0, end = 0;
};

Run longest_run(std::span<const Index> sizes) {
  constexpr std::size_t kMaxGap = 2;
  Run best, run;
  Index best_sum = 0, sum = 0;
  std::size_t gap = kMaxGap + 1;
  for (std::size_t row = 0; row < sizes.size(); ++row) {
    if (sizes[row] == 0) {
      ++gap;
      continue;
    }
    if (gap > kMaxGap) {
      run.begin = row;
      sum = 0;
    }
    gap = 0;
    run.end = row + 1;
    sum += sizes[row];
    if (sum > best_sum) {
      best_sum = sum;
      best = run;
    }
  }
  return best;
}

double height_of(std::size_t row) { return double(row) * kRowStep_mm - kViewHalfHeight_mm; }

constexpr std::size_t kRows = std::size_t(2.0 * kViewHalfHeight_mm / kRowStep_mm);

std::optional<double> find_aperture_floor(const geometry::SurfaceCrossings& front,
                                          double orbit_center_mm) {
  constexpr double kDepth_mm = 4.0, kWithin_mm = 22.0, kMiddle_mm = 5.0, kReach_mm = 55.0;
  constexpr Index kMinColumns = 5;
  constexpr std::size_t kMinRows = 8;
  std::vector<Index> sizes(kRows, 0);
  for (std::size_t row = 0; row < kRows; ++row) {
    if (height_of(row) > orbit_center_mm || height_of(row) < orbit_center_mm - kReach_mm) continue;
    const auto is_cavity = cavities_in(depths_of(front, height_of(row)), kDepth_mm, kWithin_mm);
    const Index count = count_between(is_cavity, -kMiddle_mm, kMiddle_mm).count;
    if (count >= kMinColumns) sizes[row] = count;
  }
  const Run run = longest_run(sizes);
  if (run.end < run.begin + kMinRows) return std::nullopt;
  return height_of(run.begin);
}

}  // namespace

std::optional<FacialCavities> find_facial_cavities(const geometry::SurfaceCrossings& front) {
  constexpr double kDepth_mm = 6.0, kMedial_mm = 8.0, kLateral_mm = 58.0;
  constexpr Index kMinColumns = 12;
  constexpr std::size_t kMinRows = 15;
  std::vector<Index> sizes(kRows, 0);
  std::vector<std::array<RowCavity, 2>> sides(kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    const auto is_cavity =
        cavities_in(depths_of(front, height_of(row)), kDepth_mm, 2.0 * kViewHalfWidth_mm);
    sides[row] = {count_between(is_cavity, -kLateral_mm, -kMedial_mm),
                  count_between(is_cavity, kMedial_mm, kLateral_mm)};
    const Index least = std::min(sides[row][0].count, sides[row][1].count);
    if (least >= kMinColumns) sizes[row] = least;
  }
  const Run run = longest_run(sizes);
  if (run.end < run.begin + kMinRows) return std::nullopt;
  FacialCavities found{height_of(run.begin), height_of(run.end - 1), {}, {}};
  for (std::size_t side = 0; side < 2; ++side) {
    RowCavity sum;
    for (std::size_t row = run.begin; row < run.end; ++row) {
      sum.count += sides[row][side].count;
      sum.sum_x_mm += sides[row][side].sum_x_mm;
    }
    found.orbit_center_x_mm[side] = sum.sum_x_mm / double(std::max<Index>(1, sum.count));
  }
  found.aperture_low_mm = find_aperture_floor(front, found.orbit_center_mm());
  return found;
}

}  // namespace lefort::plan::internal
