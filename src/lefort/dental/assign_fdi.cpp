#include <lefort/dental/assign_fdi.h>

#include <array>
#include <cstddef>
#include <limits>
#include <utility>

namespace lefort::dental {
namespace {

constexpr int kPositions = 16;
/// Mean mesiodistal crown widths [mm] from the central incisor to the third molar \cite nelson2010.
constexpr std::array<double, 8> kUpperWidth_mm{8.5, 6.5, 7.5, 7.0, 7.0, 10.0, 9.0, 8.5};
constexpr std::array<double, 8> kLowerWidth_mm{5.0, 5.5, 7.0, 7.0, 7.0, 11.0, 10.5, 10.0};
/// A crown may be visible in part only: its width costs less than this (Geman & McClure 1987).
constexpr double kMaxWidthCost = 7.0;
constexpr double kWidth_mm = 1.5, kDistance_mm = 2.0, kMissingDistance_mm = 1.5, kMidline_mm = 3.0;
/// Deviation of the middle of a jaw from the mid-sagittal plane.
constexpr double kDeviation_mm = 4.0, kMaxDeviation_mm = 10.0, kDeviationStep_mm = 1.0;
constexpr double kMissing = 1.5, kMissingThirdMolar = 0.0, kNoTooth = 9.0;

/// The sixteen positions of a jaw, from the right third molar to the left one.
struct Positions {
  std::array<double, kPositions> width_mm{}, center_mm{};

  explicit Positions(anatomy::Tooth jaw) {
    const auto& widths = jaw == anatomy::Tooth::kUpper ? kUpperWidth_mm : kLowerWidth_mm;
    double edge_mm = 0.0;
    for (std::size_t n = 0; n < 8; ++n) {
      width_mm[7 - n] = width_mm[8 + n] = widths[n];
      center_mm[8 + n] = edge_mm + 0.5 * widths[n];
      center_mm[7 - n] = -center_mm[8 + n];
      edge_mm += widths[n];
    }
  }
};

double squared(double value) { return value * value; }

double missing_cost(int position) {
  return position == 0 || position == kPositions - 1 ? kMissingThirdMolar : kMissing;
}

double missing_between(int from, int to) {
  double cost = 0.0;
  for (int position = from + 1; position < to; ++position) cost += missing_cost(position);
  return cost;
}

/// Cost of a part at a position.
double cost_at(const ArchPart& part, int position, const Positions& positions) {
  const auto at = std::size_t(position);
  const double width = squared((part.width_mm - positions.width_mm[at]) / kWidth_mm);
  const bool is_narrow = part.width_mm < positions.width_mm[at];
  return (is_narrow ? width / (1.0 + width / kMaxWidthCost) : width) +
         squared((part.center_mm - positions.center_mm[at]) / kMidline_mm);
}

/// Cost of two neighboring parts at two positions.
double cost_between(const ArchPart& a, int from, const ArchPart& b, int to,
                    const Positions& positions) {
  const double expected_mm =
      positions.center_mm[std::size_t(to)] - positions.center_mm[std::size_t(from)];
  const double tolerance_mm = kDistance_mm + kMissingDistance_mm * double(to - from - 1);
  return squared((b.center_mm - a.center_mm - expected_mm) / tolerance_mm) +
         missing_between(from, to);
}

/// Numbers of the parts, and what they cost.
struct Assignment {
  double cost = std::numeric_limits<double>::infinity();
  std::vector<int> fdi;
};

Assignment assign_without_deviation(std::span<const ArchPart> parts, anatomy::Tooth jaw) {
  const Positions positions(jaw);
  const std::size_t count = parts.size();
  // best[n][k]: the parts up to n, with part n at position k; part and position before it, or -1.
  struct State {
    double cost = std::numeric_limits<double>::infinity();
    std::ptrdiff_t part = -1;
    int position = -1;
  };
  std::vector<std::array<State, kPositions>> best(count);
  for (std::size_t n = 0; n < count; ++n)
    for (int k = 0; k < kPositions; ++k) {
      State& state = best[n][std::size_t(k)];
      state.cost = double(n) * kNoTooth + missing_between(-1, k);
      for (std::size_t m = 0; m < n; ++m)
        for (int l = 0; l < k; ++l) {
          const double cost = best[m][std::size_t(l)].cost + double(n - m - 1) * kNoTooth +
                              cost_between(parts[m], l, parts[n], k, positions);
          if (cost < state.cost) state = {cost, std::ptrdiff_t(m), l};
        }
      state.cost += cost_at(parts[n], k, positions);
    }
  std::vector<int> fdi(count, 0);
  double smallest = double(count) * kNoTooth + missing_between(-1, kPositions);
  std::ptrdiff_t part = -1;
  int position = -1;
  for (std::size_t n = 0; n < count; ++n)
    for (int k = 0; k < kPositions; ++k) {
      const double cost = best[n][std::size_t(k)].cost + double(count - n - 1) * kNoTooth +
                          missing_between(k, kPositions);
      if (cost < smallest) {
        smallest = cost;
        part = std::ptrdiff_t(n);
        position = k;
      }
    }
  const int right = jaw == anatomy::Tooth::kUpper ? 10 : 40;
  const int left = jaw == anatomy::Tooth::kUpper ? 20 : 30;
  while (part >= 0) {
    fdi[std::size_t(part)] = position < 8 ? right + 8 - position : left + position - 7;
    const State& state = best[std::size_t(part)][std::size_t(position)];
    part = state.part;
    position = state.position;
  }
  return {smallest, fdi};
}

}  // namespace

std::vector<int> assign_fdi(std::span<const ArchPart> parts, anatomy::Tooth jaw) {
  Assignment best;
  std::vector<ArchPart> shifted(parts.begin(), parts.end());
  constexpr int kSteps = int(kMaxDeviation_mm / kDeviationStep_mm);
  for (int step = -kSteps; step <= kSteps; ++step) {
    const double deviation_mm = kDeviationStep_mm * double(step);
    for (std::size_t n = 0; n < parts.size(); ++n)
      shifted[n].center_mm = parts[n].center_mm - deviation_mm;
    Assignment one = assign_without_deviation(shifted, jaw);
    one.cost += squared(deviation_mm / kDeviation_mm);
    if (one.cost < best.cost) best = std::move(one);
  }
  return best.fdi;
}

}  // namespace lefort::dental
