#include <lefort/anatomy/voxel_mask.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace lefort::anatomy {
namespace {

// The Gaussian is cut off this many sigmas from its center, where it has fallen below 0.4 %.
constexpr double kReach = 3.4;

/// Weights of the center and of the neighbors 1, 2, ... voxels away on either side; sum is 1.
std::vector<float> gaussian_weights(double sigma_voxels) {
  std::vector<double> weights;
  const Index reach = Index(std::ceil(kReach * sigma_voxels));
  for (Index n = 0; n <= reach; ++n)
    weights.push_back(std::exp(-0.5 * std::pow(double(n) / sigma_voxels, 2)));
  const double sum = 2.0 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights.front();
  std::vector<float> normalized;
  for (const double weight : weights) normalized.push_back(float(weight / sum));
  return normalized;
}

/// One line of voxels, its ends repeated, convolved in place.
void smooth_line(float* values, Index size, Index stride, const std::vector<float>& weights,
                 std::vector<float>& line) {
  const Index reach = Index(weights.size()) - 1;
  line.resize(std::size_t(size + 2 * reach));
  for (Index n = 0; n < size + 2 * reach; ++n)
    line[std::size_t(n)] = values[std::clamp(n - reach, Index(0), size - 1) * stride];
  for (Index n = 0; n < size; ++n) {
    const float* center = line.data() + n + reach;
    float sum = weights[0] * *center;
    for (Index away = 1; away <= reach; ++away)
      sum += weights[std::size_t(away)] * (center[-away] + center[away]);
    values[n * stride] = sum;
  }
}

}  // namespace

image::ScalarVolume smoothed(image::ScalarVolume values, const Vec3& sigma_mm) {
  LEFORT_CHECK(sigma_mm.minCoeff() >= 0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double sigma_voxels = sigma_mm[Index(axis)] / values.grid.spacing_mm[Index(axis)];
    if (sigma_voxels == 0.0) continue;
    const std::vector<float> weights = gaussian_weights(sigma_voxels);
    for_each_line(values.grid, axis, [&](Index start, Index stride) {
      thread_local std::vector<float> line;
      smooth_line(values.values.data() + start, values.grid.size[axis], stride, weights, line);
    });
  }
  return values;
}

image::ScalarVolume smoothed(image::ScalarVolume values, double sigma_mm) {
  return smoothed(std::move(values), Vec3(sigma_mm, sigma_mm, sigma_mm));
}

}  // namespace lefort::anatomy
