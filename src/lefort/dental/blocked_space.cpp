#include <lefort/core/parallel.h>
#include <lefort/dental/blocked_space.h>
#include <lefort/dental/faced_gap.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::dental {
namespace {

constexpr double kBand_mm = 1.0;

/// Distance into the arch, which has grown by the clearance, within kBand_mm.
double level_at(const geometry::Bvh& arch, const Vec3& p, double clearance_mm) {
  const auto there = offset_from(arch, p, kBand_mm + clearance_mm);
  if (!there) return -kBand_mm;
  // Behind the border of an open surface a point is neither inside nor outside.
  const bool is_inside = there->along_mm < 0.0 && !there->is_beyond;
  return clearance_mm + (is_inside ? there->distance_mm : -there->distance_mm);
}

}  // namespace

Result<image::Grid> grid_in_box(const Mat3& direction, const Box3& box, double voxel_mm) {
  constexpr double kMaxVoxels = 1e8;
  const Vec3 voxels = (box.sizes() / voxel_mm).array().ceil() + 1.0;
  if (!(voxels.prod() <= kMaxVoxels))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("a grid of {:.0f} million voxels is too large, must be {:.0f} million "
                            "or less: use larger voxels",
                            1e-6 * voxels.prod(), 1e-6 * kMaxVoxels));
  image::Grid grid;
  grid.direction = direction;
  grid.spacing_mm = Vec3::Constant(voxel_mm);
  grid.origin_L = direction * box.min();
  for (Index axis = 0; axis < 3; ++axis) grid.size[std::size_t(axis)] = Index(voxels[axis]);
  return grid;
}

BlockedSpace block_space(const geometry::Bvh& arch, const image::Grid& grid, bool is_upper,
                         double clearance_mm, const Progress& progress) {
  BlockedSpace space{{grid, std::vector<float>(std::size_t(grid.voxel_count()))},
                     std::vector<double>(std::size_t(grid.size[0] * grid.size[1]),
                                         std::numeric_limits<double>::quiet_NaN())};
  const Index layers = grid.size[2];
  parallel_for(grid.size[0] * grid.size[1], [&](Index column) {
    if (progress.stop_requested()) return;
    const Index i = column % grid.size[0], j = column / grid.size[0];
    float deepest = -float(kBand_mm);  // What lies behind is blocked at least as much.
    for (Index n = 0; n < layers; ++n) {
      const Index k = is_upper ? n : layers - 1 - n;
      const Vec3 p_L = grid.point_L({double(i), double(j), double(k)});
      const float before = deepest;
      deepest = std::max(deepest, float(level_at(arch, p_L, clearance_mm)));
      space.level.at(i, j, k) = deepest;
      if (before >= 0.0F || deepest < 0.0F) continue;
      const double behind = deepest > before ? double(deepest / (deepest - before)) : 0.0;
      const double at = is_upper ? double(k) - behind : double(k) + behind;
      space.border_mm[std::size_t(column)] = grid.spacing_mm.z() * at;
    }
  });
  return space;
}

}  // namespace lefort::dental
