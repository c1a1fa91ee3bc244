#include <lefort/compare/difference_statistics.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::compare {
namespace {

/// A distance and the area it stands for.
using Weighted = std::pair<double, double>;

/// The least distance that `share` of the area does not exceed.
double percentile(const std::vector<Weighted>& ascending, double total_mm2, double share) {
  double below_mm2 = 0.0;
  for (const auto& [distance_mm, area_mm2] : ascending) {
    below_mm2 += area_mm2;
    if (below_mm2 >= share * total_mm2) return distance_mm;
  }
  return ascending.back().first;
}

double share_below(const std::vector<Weighted>& ascending, double total_mm2, double limit_mm) {
  double below_mm2 = 0.0;
  for (const auto& [distance_mm, area_mm2] : ascending)
    if (distance_mm < limit_mm) below_mm2 += area_mm2;
  return below_mm2 / total_mm2;
}

}  // namespace

DifferenceStatistics describe(const SurfaceDifference& difference,
                              const std::function<bool(Index)>& is_asked) {
  DifferenceStatistics told;
  std::vector<Weighted> ascending;
  double compared_mm2 = 0.0, sum = 0.0, signed_sum = 0.0;
  for (std::size_t v = 0; v < difference.signed_mm.size(); ++v) {
    if (!is_asked(Index(v))) continue;
    const double area_mm2 = difference.area_mm2[v], distance_mm = difference.signed_mm[v];
    told.area_mm2 += area_mm2;
    if (std::isnan(distance_mm) || area_mm2 == 0.0) continue;
    ascending.emplace_back(std::abs(distance_mm), area_mm2);
    compared_mm2 += area_mm2;
    sum += area_mm2 * std::abs(distance_mm);
    signed_sum += area_mm2 * distance_mm;
  }
  if (ascending.empty()) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    told.mean_mm = told.median_mm = told.p90_mm = told.p95_mm = told.p99_mm = told.max_mm = kNone;
    told.share_below_1mm = told.share_below_2mm = told.mean_signed_mm = kNone;
    return told;
  }
  std::sort(ascending.begin(), ascending.end());
  told.compared_share = compared_mm2 / told.area_mm2;
  told.mean_mm = sum / compared_mm2;
  told.mean_signed_mm = signed_sum / compared_mm2;
  told.median_mm = percentile(ascending, compared_mm2, 0.5);
  told.p90_mm = percentile(ascending, compared_mm2, 0.9);
  told.p95_mm = percentile(ascending, compared_mm2, 0.95);
  told.p99_mm = percentile(ascending, compared_mm2, 0.99);
  told.max_mm = ascending.back().first;
  told.share_below_1mm = share_below(ascending, compared_mm2, 1.0);
  told.share_below_2mm = share_below(ascending, compared_mm2, 2.0);
  return told;
}

}  // namespace lefort::compare
