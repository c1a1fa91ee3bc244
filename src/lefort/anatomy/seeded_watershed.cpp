#include <lefort/anatomy/seeded_watershed.h>

#include <algorithm>
#include <array>
#include <vector>

namespace lefort::anatomy {
namespace {

// Widths are rounded to these levels; all widths above the last level are equal.
constexpr double kLevel_mm = 0.1;
constexpr std::size_t kLevels = 1000;

std::size_t level_of(float half_width_mm) {
  return std::size_t(std::clamp(double(half_width_mm) / kLevel_mm, 0.0, double(kLevels - 1)));
}

}  // namespace

image::Volume<std::int32_t> seeded_watershed(const image::Volume<std::int32_t>& seeds,
                                             const Mask& room,
                                             const image::ScalarVolume& half_width_mm) {
  const image::Grid& grid = room.grid;
  image::Volume<std::int32_t> basins = seeds;
  // One first-in-first-out queue per level; the largest width comes first.
  std::vector<std::vector<Index>> queues(kLevels);
  for (Index v = 0; v < grid.voxel_count(); ++v)
    if (seeds.values[std::size_t(v)] != 0)
      queues[level_of(half_width_mm.values[std::size_t(v)])].push_back(v);

  const std::array<Index, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (std::size_t level = kLevels; level-- > 0;) {
    // Behind a narrow passage wide voxels have the level of the passage. So queues grow only at
    // this level or below; this one may grow during the loop.
    for (std::size_t next = 0; next < queues[level].size(); ++next) {
      const Index v = queues[level][next];
      Index rest = v;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Index position = rest % grid.size[axis];
        rest /= grid.size[axis];
        for (const int side : {-1, 1}) {
          if (position + side < 0 || position + side >= grid.size[axis]) continue;
          const std::size_t other = std::size_t(v + side * stride[axis]);
          if (room.values[other] == 0 || basins.values[other] != 0) continue;
          basins.values[other] = basins.values[std::size_t(v)];
          queues[std::min(level, level_of(half_width_mm.values[other]))].push_back(Index(other));
        }
      }
    }
    queues[level] = {};
  }
  return basins;
}

}  // namespace lefort::anatomy
