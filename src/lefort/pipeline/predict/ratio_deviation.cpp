#include <lefort/pipeline/predict/ratio_deviation.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::pipeline {
namespace {

using compare::SoftTissueRatio;

const SoftTissueRatio* find_same(std::span<const SoftTissueRatio> ratios,
                                 const SoftTissueRatio& one) {
  const auto same = std::find_if(ratios.begin(), ratios.end(), [&](const SoftTissueRatio& other) {
    return other.segment == one.segment && other.axis == one.axis && other.soft == one.soft &&
           other.hard == one.hard;
  });
  return same == ratios.end() ? nullptr : &*same;
}

/// Whether the interval contains a ratio that the published range contains.
bool overlaps(const compare::PublishedRange& range, double low, double high) {
  return range.contains(low) || range.contains(high) || (low <= range.low && range.high <= high);
}

std::string interface_reason(const ExplainedRatio& explained) {
  const RatioByInterface& by = *explained.by_interface;
  const double ratio = explained.ratio.ratio();
  const double low = std::min({by.attached, by.contact, ratio});
  const double high = std::max({by.attached, by.contact, ratio});
  const std::string extent =
      fmt::format("on the coarse mesh it is {:.2f} by contact and {:.2f} with attached tissue",
                  by.contact, by.attached);
  return overlaps(*explained.ratio.published, low, high)
             ? fmt::format("Interface of tissue and bone: {}, so that the interface explains it.",
                           extent)
             : fmt::format("Not the interface of tissue and bone alone: {}.", extent);
}

/// What the model lacks at a landmark; empty if nothing is known.
std::string missing_anatomy(const std::string& soft) {
  if (soft == "Prn" || soft == "Sn" || soft.starts_with("Al"))
    return "The model has no cartilage: septum and tip of the nose are soft tissue, and follow the "
           "maxilla. Sutures at the base of the nose are not modeled.";
  if (soft == "Ls" || soft == "Stm" || soft == "Li" || soft == compare::kUpperLip)
    return "The model has no muscle tone: the lips keep the posture of the scan.";
  return {};
}

}  // namespace

std::vector<ExplainedRatio> with_interfaces(std::span<const SoftTissueRatio> ratios,
                                            std::span<const SoftTissueRatio> attached,
                                            std::span<const SoftTissueRatio> contact) {
  std::vector<ExplainedRatio> explained;
  for (const SoftTissueRatio& ratio : ratios) {
    explained.push_back({ratio});
    const SoftTissueRatio *const one = find_same(attached, ratio), *const other =
                                                                       find_same(contact, ratio);
    if (one != nullptr && other != nullptr)
      explained.back().by_interface = RatioByInterface{one->ratio(), other->ratio()};
  }
  return explained;
}

void measure_scan_boundary(std::vector<ExplainedRatio>& ratios,
                           std::span<const plan::Landmark> landmarks_L,
                           std::span<const Vec3> scan_boundary_L) {
  for (ExplainedRatio& one : ratios) {
    const auto at = std::find_if(landmarks_L.begin(), landmarks_L.end(), [&](const auto& landmark) {
      return landmark.name == one.ratio.soft;
    });
    if (at == landmarks_L.end()) continue;
    double squared_mm2 = std::numeric_limits<double>::infinity();
    for (const Vec3& node_L : scan_boundary_L)
      squared_mm2 = std::min(squared_mm2, (node_L - at->point_L).squaredNorm());
    if (squared_mm2 <= kNearScanBoundary_mm * kNearScanBoundary_mm)
      one.scan_boundary_mm = std::sqrt(squared_mm2);
  }
}

bool deviates(const SoftTissueRatio& ratio) {
  return ratio.published && !ratio.published->contains(ratio.ratio());
}

std::vector<std::string> deviation_reasons(const ExplainedRatio& explained) {
  const SoftTissueRatio& ratio = explained.ratio;
  if (!deviates(ratio)) return {};
  std::vector<std::string> reasons;
  if (explained.by_interface) reasons.push_back(interface_reason(explained));
  if (explained.scan_boundary_mm)
    reasons.push_back(
        fmt::format("The scan ends {:.0f} mm from the landmark.", *explained.scan_boundary_mm));
  if (std::string missing = missing_anatomy(ratio.soft); !missing.empty())
    reasons.push_back(std::move(missing));
  if (!(ratio.published->low < ratio.published->high))
    reasons.emplace_back("The published figure is one mean; patients differ by more than 0.1.");
  if (!ratio.is_main_axis)
    reasons.push_back(
        fmt::format("Not the main axis of the movement: the bone moves {:.1f} mm along "
                    "it, so that movements along other axes change the ratio.",
                    std::abs(ratio.hard_mm)));
  if (reasons.empty()) reasons.emplace_back("No reason was found.");
  return reasons;
}

}  // namespace lefort::pipeline
