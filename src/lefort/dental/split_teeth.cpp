#include <lefort/anatomy/seeded_watershed.h>
#include <lefort/dental/split_teeth.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

namespace lefort::dental {
namespace {

/// Components of the voxels above a falling level, each with its highest voxel.
class LevelComponents {
 public:
  explicit LevelComponents(std::size_t voxels) : parent_(voxels, -1) {}

  [[nodiscard]] bool is_above(Index v) const { return parent_[std::size_t(v)] >= 0; }
  void add(Index v) { parent_[std::size_t(v)] = v; }
  /// The highest voxel of the component.
  Index peak(Index v) {
    while (parent_[std::size_t(v)] != v) {
      parent_[std::size_t(v)] = parent_[std::size_t(parent_[std::size_t(v)])];
      v = parent_[std::size_t(v)];
    }
    return v;
  }
  /// The lower peak is no longer one.
  void join(Index lower, Index higher) { parent_[std::size_t(lower)] = higher; }

 private:
  std::vector<Index> parent_;
};

/// Voxels of the set by falling height, equal ones by offset.
std::vector<Index> by_height(const anatomy::Mask& set, const image::ScalarVolume& height) {
  std::vector<Index> order;
  for (std::size_t v = 0; v < set.values.size(); ++v)
    if (set.values[v] != 0) order.push_back(Index(v));
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return height.values[std::size_t(a)] > height.values[std::size_t(b)];
  });
  return order;
}

/// Maxima whose dynamic is large enough (\cite grimaud1992): the height that must be lost on the
/// way to a higher maximum.
std::vector<Index> maxima(const anatomy::Mask& set, const image::ScalarVolume& height,
                          double dynamic) {
  const auto& size = set.grid.size;
  LevelComponents components(set.values.size());
  std::vector<std::uint8_t> is_low(set.values.size(), 0);
  const std::vector<Index> order = by_height(set, height);
  std::vector<Index> peaks;
  for (const Index v : order) {
    components.add(v);
    bool is_peak = true;
    const std::array<Index, 3> at{v % size[0], v / size[0] % size[1], v / (size[0] * size[1])};
    for (Index n = 0; n < 27; ++n) {
      const Index i = at[0] + n % 3 - 1, j = at[1] + n / 3 % 3 - 1, k = at[2] + n / 9 - 1;
      if (!set.grid.contains(i, j, k)) continue;
      const Index next = set.grid.offset(i, j, k);
      if (next == v || !components.is_above(next)) continue;
      is_peak = false;
      Index a = components.peak(v), b = components.peak(next);
      if (a == b) continue;
      const auto h = [&](Index w) { return height.values[std::size_t(w)]; };
      if (h(a) > h(b) || (h(a) == h(b) && a < b)) std::swap(a, b);
      if (double(h(a) - h(v)) < dynamic) is_low[std::size_t(a)] = 1;
      components.join(a, b);
    }
    if (is_peak) peaks.push_back(v);
  }
  std::erase_if(peaks, [&](Index v) { return is_low[std::size_t(v)] != 0; });
  return peaks;
}

}  // namespace

image::Volume<std::int32_t> split_teeth(const anatomy::Mask& teeth, double dynamic_mm) {
  const image::ScalarVolume depth_mm = anatomy::distance_to(
      anatomy::mask_where(teeth.grid, [&](std::size_t v) { return teeth.values[v] == 0; }));
  image::Volume<std::int32_t> seeds{teeth.grid, std::vector<std::int32_t>(teeth.values.size(), 0)};
  std::int32_t number = 0;
  for (const Index v : maxima(teeth, depth_mm, dynamic_mm)) seeds.values[std::size_t(v)] = ++number;
  return anatomy::seeded_watershed(seeds, teeth, depth_mm);
}

}  // namespace lefort::dental
