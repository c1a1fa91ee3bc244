#include <lefort/anatomy/separate_levels.h>
#include <lefort/core/check.h>

#include <algorithm>
#include <utility>

namespace lefort::anatomy {
namespace {

// Distances to a label are clamped to this ...
constexpr double kClamp_voxels = 3.0;
// ... and functions are not limited where the side is close to it.
constexpr double kLimited_voxels = 2.5;
// Sigma of the Gaussian that removes voxel steps from the border between two labels.
constexpr double kSteps_voxels = 0.8;
// Level of a voxel that is removed from the second label.
constexpr double kRemoved_voxels = -0.25;

/// Distance to the border of a set in voxels, negative inside.
image::ScalarVolume signed_voxels(Mask mask) {
  mask.grid.spacing_mm = Vec3::Ones();
  image::ScalarVolume distance = distance_to(mask);
  const image::ScalarVolume inside =
      distance_to(mask_where(mask.grid, [&](std::size_t v) { return mask.values[v] == 0; }));
  for (std::size_t v = 0; v < mask.values.size(); ++v) {
    const double voxels =
        mask.values[v] != 0 ? 0.5 - double(inside.values[v]) : double(distance.values[v]) - 0.5;
    distance.values[v] = float(std::clamp(voxels, -kClamp_voxels, kClamp_voxels));
  }
  return distance;
}

/// Sets voxels of `second` that are inside and adjacent to the inside of `first` to `removed`.
void clear_adjacent(const image::ScalarVolume& first, float removed, image::ScalarVolume& second) {
  const auto& size = first.grid.size;
  const auto touches = [&](Index i, Index j, Index k) {
    for (Index c = std::max<Index>(k - 1, 0); c <= std::min(k + 1, size[2] - 1); ++c)
      for (Index b = std::max<Index>(j - 1, 0); b <= std::min(j + 1, size[1] - 1); ++b)
        for (Index a = std::max<Index>(i - 1, 0); a <= std::min(i + 1, size[0] - 1); ++a)
          if (first.at(a, b, c) >= 0.0F) return true;
    return false;
  };
  parallel_for(size[2], [&](Index k) {
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i)
        if (second.at(i, j, k) >= 0.0F && touches(i, j, k)) second.at(i, j, k) = removed;
  });
}

}  // namespace

void separate_levels(const Mask& in_first, const Mask& in_second, image::ScalarVolume& first_mm,
                     image::ScalarVolume& second_mm) {
  const image::Grid& grid = in_first.grid;
  LEFORT_CHECK(in_second.grid == grid && first_mm.grid == grid && second_mm.grid == grid);
  image::ScalarVolume side = signed_voxels(in_second);
  {
    const image::ScalarVolume to_first = signed_voxels(in_first);
    for (std::size_t v = 0; v < side.values.size(); ++v)
      side.values[v] = 0.5F * (side.values[v] - to_first.values[v]);
  }
  side = smoothed(std::move(side), kSteps_voxels);  // Its grid has unit spacing.
  // The smallest spacing converts voxels to mm: the magnitude is at most the distance.
  const double voxel_mm = grid.spacing_mm.minCoeff();
  for (std::size_t v = 0; v < side.values.size(); ++v) {
    const double at_voxels = double(side.values[v]);
    if (at_voxels < kLimited_voxels)
      first_mm.values[v] =
          std::min(first_mm.values[v], float(voxel_mm * (at_voxels - kHalfGap_voxels)));
    if (-at_voxels < kLimited_voxels)
      second_mm.values[v] =
          std::min(second_mm.values[v], float(voxel_mm * (-at_voxels - kHalfGap_voxels)));
  }
  clear_adjacent(first_mm, float(kRemoved_voxels * voxel_mm), second_mm);
}

}  // namespace lefort::anatomy
