#include <lefort/anatomy/voxel_mask.h>
#include <lefort/anatomy/warp_volume.h>
#include <lefort/core/parallel.h>
#include <lefort/image/interpolate.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace lefort::anatomy {
namespace {

constexpr double kFieldSpacing_mm = 2.0;
/// Three boxes of 2 * 2 + 1 nodes: a standard deviation of 2.4 nodes, nearly 5 mm.
constexpr Index kBoxReach = 2;
constexpr int kBoxes = 3;
/// Where points end, the displacement fades over twice its length, so that it does not fold.
constexpr double kFadeStart_mm = 4.0, kMinFade_mm = 8.0, kMaxFade_mm = 40.0;

/// Sum of displacements and their number.
using Sums = std::vector<Eigen::Vector4d>;

/// Sums over the neighbors along one axis.
void blur_along(const image::Grid& grid, std::size_t axis, Sums& sums) {
  const std::array<Index, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  const Sums before = sums;
  parallel_for(grid.voxel_count(), [&](Index v) {
    const Index at = v / stride[axis] % grid.size[axis];
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (Index n = std::max<Index>(at - kBoxReach, 0);
         n <= std::min(at + kBoxReach, grid.size[axis] - 1); ++n)
      sum += before[std::size_t(v + (n - at) * stride[axis])];
    sums[std::size_t(v)] = sum;
  });
}

image::Grid grid_of(const Box3& box_L) {
  image::Grid grid;
  grid.spacing_mm = Vec3::Constant(kFieldSpacing_mm);
  grid.origin_L = box_L.min();
  for (int axis = 0; axis < 3; ++axis)
    grid.size[std::size_t(axis)] =
        std::max<Index>(2, Index(std::ceil(box_L.sizes()[axis] / kFieldSpacing_mm)) + 1);
  return grid;
}

/// Mean of what is known around each node, and 0 known where nothing is.
void fill_once(const image::Grid& grid, Sums& means) {
  Sums around = means;
  for (std::size_t axis = 0; axis < 3; ++axis) blur_along(grid, axis, around);
  for (std::size_t v = 0; v < means.size(); ++v)
    if (means[v].w() == 0.0 && around[v].w() > 0.0) means[v] = around[v] / around[v].w();
}

/// 1 close to the points, 0 further than `far_mm`, smooth between.
double fade(double distance_mm, double far_mm) {
  const double t = std::clamp((distance_mm - kFadeStart_mm) / (far_mm - kFadeStart_mm), 0.0, 1.0);
  return 1.0 - t * t * (3.0 - 2.0 * t);
}

}  // namespace

DisplacementField::DisplacementField(std::span<const MovedPoint> points, const Box3& box_L)
    : grid_(grid_of(box_L)) {
  Mask occupied{grid_, std::vector<std::uint8_t>(std::size_t(grid_.voxel_count()), 0)};
  double max_mm = 0.0;
  Sums sums(std::size_t(grid_.voxel_count()), Eigen::Vector4d::Zero());
  for (const MovedPoint& one : points) {
    const Vec3 at = grid_.index_V(one.point_L);
    const auto i = Index(std::lround(at.x())), j = Index(std::lround(at.y())),
               k = Index(std::lround(at.z()));
    if (!grid_.contains(i, j, k)) continue;
    occupied.at(i, j, k) = 1;
    max_mm = std::max(max_mm, one.shift_mm.norm());
    sums[std::size_t(grid_.offset(i, j, k))] +=
        Eigen::Vector4d(one.shift_mm.x(), one.shift_mm.y(), one.shift_mm.z(), 1.0);
  }
  // Each node counts once, so that dense points do not dominate.
  for (Eigen::Vector4d& sum : sums)
    if (sum.w() > 0.0) sum /= sum.w();
  for (int n = 0; n < kBoxes; ++n)
    for (std::size_t axis = 0; axis < 3; ++axis) blur_along(grid_, axis, sums);
  for (Eigen::Vector4d& sum : sums)
    if (sum.w() > 0.0) sum /= sum.w();
  const double far_mm = kFadeStart_mm + std::clamp(2.0 * max_mm, kMinFade_mm, kMaxFade_mm);
  const int fills = int(std::ceil(far_mm / (kFieldSpacing_mm * double(kBoxReach))));
  for (int n = 0; n < fills; ++n) fill_once(grid_, sums);
  const image::ScalarVolume away = distance_to(occupied, far_mm);
  shifts_mm_.resize(sums.size());
  for (std::size_t v = 0; v < sums.size(); ++v)
    shifts_mm_[v] = fade(double(away.values[v]), far_mm) * sums[v].head<3>();
}

Vec3 DisplacementField::at(const Vec3& p_L) const {
  image::internal::Cell cell;
  if (!image::internal::find_cell(grid_, p_L, cell)) return Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    Index offset = cell.offset;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_upper = (corner >> axis & 1) != 0;
      weight *= is_upper ? cell.fraction[axis] : 1.0 - cell.fraction[axis];
      if (is_upper) offset += cell.step[std::size_t(axis)];
    }
    sum += weight * shifts_mm_[std::size_t(offset)];
  }
  return sum;
}

Vec3 DisplacementField::before(const Vec3& q_L) const {
  constexpr int kIterations = 40;
  constexpr double kClose_mm = 0.005;
  Vec3 p_L = q_L;
  for (int n = 0; n < kIterations; ++n) {
    const Vec3 next_L = q_L - at(p_L);
    const double moved_mm = (next_L - p_L).norm();
    p_L = next_L;
    if (moved_mm < kClose_mm) break;
  }
  return p_L;
}

image::CtVolume warped(const image::CtVolume& volume, const DisplacementField& field,
                       std::int16_t outside) {
  image::CtVolume after{volume.grid, std::vector<std::int16_t>(volume.values.size())};
  parallel_for(volume.grid.voxel_count(), [&](Index v) {
    const Vec3 p_L = field.before(volume.grid.center_L(v));
    after.values[std::size_t(v)] =
        std::int16_t(std::lround(image::interpolate(volume, p_L, double(outside))));
  });
  return after;
}

}  // namespace lefort::anatomy
