#include <lefort/contact/contact_statistics.h>
#include <lefort/contact/measure_gap.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace lefort::contact {
namespace {

/// Fraction of the area in contact that may lie deeper than the P99.
constexpr double kBeyondP99 = 0.01;

/// \returns the depth that all but the deepest `fraction` of the area does not exceed.
double depth_at_fraction(std::vector<std::pair<double, double>> depth_and_area, double fraction) {
  std::sort(depth_and_area.begin(), depth_and_area.end(), std::greater<>());
  double total_mm2 = 0.0, passed_mm2 = 0.0;
  for (const auto& [depth_mm, area_mm2] : depth_and_area) total_mm2 += area_mm2;
  for (const auto& [depth_mm, area_mm2] : depth_and_area) {
    passed_mm2 += area_mm2;
    if (passed_mm2 > fraction * total_mm2) return depth_mm;
  }
  return 0.0;
}

Index count_distinct(std::vector<std::int32_t> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return Index(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}

}  // namespace

ContactStatistics combine(const ContactStatistics& a, const ContactStatistics& b) {
  const double sampled_mm2 = a.sampled_area_mm2 + b.sampled_area_mm2;
  const auto mean = [&](double of_a, double of_b) {
    return sampled_mm2 > 0.0 ? (a.sampled_area_mm2 * of_a + b.sampled_area_mm2 * of_b) / sampled_mm2
                             : 0.0;
  };
  return {.points = a.points + b.points,
          .nodes = a.nodes + b.nodes,
          .area_mm2 = a.area_mm2 + b.area_mm2,
          .sampled_area_mm2 = sampled_mm2,
          .max_penetration_mm = std::max(a.max_penetration_mm, b.max_penetration_mm),
          .mean_penetration_mm = mean(a.mean_penetration_mm, b.mean_penetration_mm),
          .max_penetration_increase_mm =
              std::max(a.max_penetration_increase_mm, b.max_penetration_increase_mm),
          .mean_penetration_increase_mm =
              mean(a.mean_penetration_increase_mm, b.mean_penetration_increase_mm),
          .p99_penetration_increase_mm =
              std::max(a.p99_penetration_increase_mm, b.p99_penetration_increase_mm),
          .max_bone_penetration_increase_mm =
              std::max(a.max_bone_penetration_increase_mm, b.max_bone_penetration_increase_mm),
          .p99_bone_penetration_increase_mm =
              std::max(a.p99_bone_penetration_increase_mm, b.p99_bone_penetration_increase_mm),
          .force_L_n = a.force_L_n + b.force_L_n,
          .normal_force_n = a.normal_force_n + b.normal_force_n};
}

void ContactStatisticsSum::add(const PointContact& point, std::span<const std::int32_t> nodes) {
  if (!(point.pressure_mpa > 0.0)) return;
  const Vec3 force_n = point.area_mm2 * point.pressure_mpa * point.gradient_L;
  ++sum_.points;
  nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
  sum_.area_mm2 += point.area_mm2;
  sum_.force_L_n += force_n;
  sum_.normal_force_n += force_n.norm();
}

void ContactStatisticsSum::add(const DepthSample& sample) {
  const double penetration_mm = std::max(-sample.gap_mm, 0.0);
  sum_.sampled_area_mm2 += sample.area_mm2;
  sum_.max_penetration_mm = std::max(sum_.max_penetration_mm, penetration_mm);
  sum_.mean_penetration_mm += sample.area_mm2 * penetration_mm;
  sum_.max_penetration_increase_mm = std::max(sum_.max_penetration_increase_mm, sample.depth_mm);
  sum_.mean_penetration_increase_mm += sample.area_mm2 * sample.depth_mm;
  depth_and_area_.emplace_back(sample.depth_mm, sample.area_mm2);
  sum_.max_bone_penetration_increase_mm =
      std::max(sum_.max_bone_penetration_increase_mm, sample.bone_depth_mm);
  bone_depth_and_area_.emplace_back(sample.bone_depth_mm, sample.area_mm2);
}

ContactStatistics ContactStatisticsSum::finish() && {
  sum_.p99_penetration_increase_mm =
      std::max(depth_at_fraction(std::move(depth_and_area_), kBeyondP99), 0.0);
  sum_.p99_bone_penetration_increase_mm =
      std::max(depth_at_fraction(std::move(bone_depth_and_area_), kBeyondP99), 0.0);
  sum_.nodes = count_distinct(std::move(nodes_));
  if (sum_.sampled_area_mm2 > 0.0) {
    sum_.mean_penetration_mm /= sum_.sampled_area_mm2;
    sum_.mean_penetration_increase_mm /= sum_.sampled_area_mm2;
  }
  return sum_;
}

void NodalContactSum::add(const PointContact& point, std::span<const std::int32_t> nodes,
                          std::span<const double> N) {
  const double p_mpa = point.pressure_mpa * point.gradient_L.norm();
  const double depth_mm = p_mpa > 0.0 ? point.depth_mm : 0.0;
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const double weight_mm2 = point.area_mm2 * std::abs(N[a]);
    Node& node = nodes_[nodes[a]];
    node.contact.pressure_mpa += weight_mm2 * p_mpa;
    node.contact.depth_mm = std::max(node.contact.depth_mm, depth_mm);
    node.area_mm2 += weight_mm2;
  }
}

std::vector<NodalContact> NodalContactSum::finish(const RigidObstacle& obstacle,
                                                  std::span<const Vec3> x_L) && {
  std::vector<NodalContact> all;
  for (auto& [number, node] : nodes_) {
    const Gap gap = measure_gap(obstacle, x_L[std::size_t(number)], Derivatives::kFirst);
    node.contact.node = number;
    node.contact.pressure_mpa /= node.area_mm2;
    node.contact.gap_mm =
        gap.zone == field::Zone::kUnknown ? std::numeric_limits<double>::quiet_NaN() : gap.gap_mm;
    all.push_back(node.contact);
  }
  return all;
}

}  // namespace lefort::contact
