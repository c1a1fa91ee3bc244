#include <lefort/anatomy/histogram_thresholds.h>

#include <algorithm>
#include <vector>

namespace lefort::anatomy {
namespace {

constexpr int kBins = 512;  // 8 HU each over the range of a 12-bit CT.

/// Counts and sums of values below each edge of the bins.
struct Histogram {
  double lowest, width;
  std::vector<double> count = std::vector<double>(kBins + 1, 0.0);
  std::vector<double> sum = std::vector<double>(kBins + 1, 0.0);

  [[nodiscard]] double edge(int bin) const { return lowest + width * bin; }
  [[nodiscard]] double voxels(int from, int to) const {
    return count[std::size_t(to)] - count[std::size_t(from)];
  }
  [[nodiscard]] double mean(int from, int to) const {
    return (sum[std::size_t(to)] - sum[std::size_t(from)]) / voxels(from, to);
  }
  /// What a class adds to the variance between classes, up to a constant.
  [[nodiscard]] double spread(int from, int to) const {
    const double n = voxels(from, to);
    if (n <= 0.0) return 0.0;
    const double m = mean(from, to);
    return n * m * m;
  }
};

Histogram histogram_of(const image::CtVolume& ct, double lowest, double highest) {
  Histogram histogram{lowest, (highest - lowest) / kBins};
  for (const std::int16_t value : ct.values) {
    const int bin = std::min(int((value - lowest) / histogram.width), kBins - 1);
    histogram.count[std::size_t(bin) + 1] += 1.0;
    histogram.sum[std::size_t(bin) + 1] += value;
  }
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    histogram.count[bin + 1] += histogram.count[bin];
    histogram.sum[bin + 1] += histogram.sum[bin];
  }
  return histogram;
}

}  // namespace

Result<HistogramThresholds> find_thresholds(const image::CtVolume& ct) {
  const auto [lowest, highest] = std::minmax_element(ct.values.begin(), ct.values.end());
  if (lowest == ct.values.end() || *highest - *lowest < 3)
    return fail(ErrorCode::kAnatomyMissing,
                "scan has too few different values to find air, soft tissue and bone among them");
  const Histogram histogram = histogram_of(ct, *lowest, *highest);
  double best = -1.0;
  int skin = 0, bone = 0;
  for (int a = 1; a < kBins; ++a)
    for (int b = a + 1; b < kBins; ++b) {
      const double between =
          histogram.spread(0, a) + histogram.spread(a, b) + histogram.spread(b, kBins);
      if (between > best) best = between, skin = a, bone = b;
    }
  for (const auto& [from, to] : {std::pair(0, skin), std::pair(skin, bone), std::pair(bone, kBins)})
    if (histogram.voxels(from, to) <= 0.0)
      return fail(ErrorCode::kAnatomyMissing,
                  "scan has too few different values to find air, soft tissue and bone among them");
  return HistogramThresholds{histogram.edge(skin), histogram.edge(bone), histogram.mean(0, skin),
                             histogram.mean(skin, bone), histogram.mean(bone, kBins)};
}

}  // namespace lefort::anatomy
