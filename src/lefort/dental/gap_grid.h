/// \file
/// The gap over an arch at the nodes of a regular grid: faster than closest points, for a search.
#pragma once

#include <lefort/core/types.h>
#include <lefort/dental/faced_gap.h>
#include <lefort/geometry/bvh.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lefort::dental {

/// Between nodes the gap is trilinear, so that cusps smaller than the spacing are smoothed.
class GapGrid {
 public:
  static constexpr double kReach_mm = 6.0, kSpacing_mm = 0.8;

  /// \param surface  an arch. \pre it passed check_arch(), which limits the size of the grid.
  /// \param points   the part of it that can face others; gaps reach kReach_mm from their box.
  GapGrid(const geometry::Bvh& surface, std::span<const Vec3> points);

  /// As gap_over; the point of the surface is that along the normal.
  [[nodiscard]] std::optional<FacedGap> gap_over(const Vec3& p, const Vec3& n) const;

 private:
  Vec3 low_ = Vec3::Zero();
  std::array<Index, 3> size_{};
  std::vector<float> gaps_mm_;  ///< x fastest; NaN without a surface, or beyond its border.
};

}  // namespace lefort::dental
