#include <lefort/core/parallel.h>
#include <lefort/dental/faced_gap.h>
#include <lefort/dental/gap_grid.h>

#include <cmath>
#include <limits>

namespace lefort::dental {

GapGrid::GapGrid(const geometry::Bvh& surface, std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  if (box.isEmpty()) return;
  low_ = box.min() - Vec3::Constant(kReach_mm);
  for (Index axis = 0; axis < 3; ++axis)
    size_[std::size_t(axis)] =
        Index(std::ceil((box.sizes()[axis] + 2.0 * kReach_mm) / kSpacing_mm)) + 1;
  gaps_mm_.assign(std::size_t(size_[0] * size_[1] * size_[2]),
                  std::numeric_limits<float>::quiet_NaN());
  parallel_for(size_[1] * size_[2], [&](Index line) {
    const Index j = line % size_[1], k = line / size_[1];
    for (Index i = 0; i < size_[0]; ++i) {
      const Vec3 p = low_ + kSpacing_mm * Vec3(double(i), double(j), double(k));
      const auto there = offset_from(surface, p, kReach_mm);
      if (there && !there->is_beyond)
        gaps_mm_[std::size_t(line * size_[0] + i)] = float(there->along_mm);
    }
  });
}

std::optional<FacedGap> GapGrid::gap_over(const Vec3& p, const Vec3& n) const {
  const Vec3 at = (p - low_) / kSpacing_mm;
  std::array<Index, 3> cell{};
  Vec3 t;
  for (Index axis = 0; axis < 3; ++axis) {
    const double floor = std::floor(at[axis]);
    if (!(floor >= 0.0 && floor + 1.0 < double(size_[std::size_t(axis)]))) return std::nullopt;
    cell[std::size_t(axis)] = Index(floor);
    t[axis] = at[axis] - floor;
  }
  double gap_mm = 0.0;
  Vec3 gradient = Vec3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 weight, slope;
    Index node = 0;
    for (Index axis = 2; axis >= 0; --axis) {
      const bool is_high = (corner >> axis & 1) != 0;
      weight[axis] = is_high ? t[axis] : 1.0 - t[axis];
      slope[axis] = is_high ? 1.0 : -1.0;
      node = node * size_[std::size_t(axis)] + cell[std::size_t(axis)] + (is_high ? 1 : 0);
    }
    const double value_mm = gaps_mm_[std::size_t(node)];
    gap_mm += value_mm * weight.prod();
    gradient +=
        value_mm * Vec3(slope.x() * weight.y() * weight.z(), weight.x() * slope.y() * weight.z(),
                        weight.x() * weight.y() * slope.z());
  }
  const double length = gradient.norm();
  if (!(length > 0.0)) return std::nullopt;  // Also without a gap at one of the nodes.
  const Vec3 normal = gradient / length;
  if (!(normal.dot(n) < kFacingCosine)) return std::nullopt;
  return FacedGap{gap_mm, p - gap_mm * normal, normal};
}

}  // namespace lefort::dental
