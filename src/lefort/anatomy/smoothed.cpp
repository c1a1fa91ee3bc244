#include <lefort/anatomy/voxel_mask.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace lefort::anatomy {
namespace {

// The Gaussian is truncated at this many sigmas, where it is below 0.4 % of its maximum.
constexpr double kCutoff_sigmas = 3.4;

/// Weights of the center and of the neighbors at 1, 2, ... voxels on either side; the sum over both
/// sides is 1.
std::vector<float> gaussian_weights(double sigma_voxels) {
  std::vector<double> weights;
  const Index cutoff = Index(std::ceil(kCutoff_sigmas * sigma_voxels));
  for (Index n = 0; n <= cutoff; ++n)
    weights.push_back(std::exp(-0.5 * std::pow(double(n) / sigma_voxels, 2)));
  const double sum = 2.0 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights.front();
  std::vector<float> normalized;
  for (const double weight : weights) normalized.push_back(float(weight / sum));
  return normalized;
}

/// Convolves one line of voxels in place; its ends are repeated.
void smooth_line(float* values, Index size, Index stride, const std::vector<float>& weights,
                 std::vector<float>& line) {
  const Index cutoff = Index(weights.size()) - 1;
  line.resize(std::size_t(size + 2 * cutoff));
  for (Index n = 0; n < size + 2 * cutoff; ++n)
    line[std::size_t(n)] = values[std::clamp(n - cutoff, Index(0), size - 1) * stride];
  for (Index n = 0; n < size; ++n) {
    const float* center = line.data() + n + cutoff;
    float sum = weights[0] * *center;
    for (Index distance = 1; distance <= cutoff; ++distance)
      sum += weights[std::size_t(distance)] * (center[-distance] + center[distance]);
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
