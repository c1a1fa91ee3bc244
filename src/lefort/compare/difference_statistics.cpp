#include <lefort/compare/difference_statistics.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::compare {
namespace {

/// A distance and its area.
using Weighted = std::pair<double, double>;

/// \returns the smallest distance that is not exceeded on `fraction` of the area.
double percentile(const std::vector<Weighted>& ascending, double total_mm2, double fraction) {
  double below_mm2 = 0.0;
  for (const auto& [distance_mm, area_mm2] : ascending) {
    below_mm2 += area_mm2;
    if (below_mm2 >= fraction * total_mm2) return distance_mm;
  }
  return ascending.back().first;
}

double fraction_below(const std::vector<Weighted>& ascending, double total_mm2, double limit_mm) {
  double below_mm2 = 0.0;
  for (const auto& [distance_mm, area_mm2] : ascending)
    if (distance_mm < limit_mm) below_mm2 += area_mm2;
  return below_mm2 / total_mm2;
}

}  // namespace

DifferenceStatistics describe(const SurfaceDifference& difference,
                              const std::function<bool(Index)>& is_requested) {
  DifferenceStatistics reported;
  std::vector<Weighted> ascending;
  double compared_mm2 = 0.0, sum = 0.0, signed_sum = 0.0;
  for (std::size_t v = 0; v < difference.signed_mm.size(); ++v) {
    if (!is_requested(Index(v))) continue;
    const double area_mm2 = difference.area_mm2[v], distance_mm = difference.signed_mm[v];
    reported.area_mm2 += area_mm2;
    if (std::isnan(distance_mm) || area_mm2 == 0.0) continue;
    ascending.emplace_back(std::abs(distance_mm), area_mm2);
    compared_mm2 += area_mm2;
    sum += area_mm2 * std::abs(distance_mm);
    signed_sum += area_mm2 * distance_mm;
  }
  if (ascending.empty()) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    reported.mean_mm = reported.median_mm = reported.p90_mm = reported.p95_mm = reported.p99_mm =
        reported.max_mm = kNone;
    reported.fraction_below_1mm = reported.fraction_below_2mm = reported.mean_signed_mm = kNone;
    return reported;
  }
  std::sort(ascending.begin(), ascending.end());
  reported.compared_fraction = compared_mm2 / reported.area_mm2;
  reported.mean_mm = sum / compared_mm2;
  reported.mean_signed_mm = signed_sum / compared_mm2;
  reported.median_mm = percentile(ascending, compared_mm2, 0.5);
  reported.p90_mm = percentile(ascending, compared_mm2, 0.9);
  reported.p95_mm = percentile(ascending, compared_mm2, 0.95);
  reported.p99_mm = percentile(ascending, compared_mm2, 0.99);
  reported.max_mm = ascending.back().first;
  reported.fraction_below_1mm = fraction_below(ascending, compared_mm2, 1.0);
  reported.fraction_below_2mm = fraction_below(ascending, compared_mm2, 2.0);
  return reported;
}

}  // namespace lefort::compare
