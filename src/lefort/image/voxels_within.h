/// \file
/// The voxels around a point.
#pragma once

#include <lefort/image/volume.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lefort::image {

/// Calls visit(i, j, k), i fastest, with each voxel of the grid that reaches as near as `reach_mm`
/// to p_L along every axis: all within a ball of that radius, and some in the corners around it.
template <class Visit>
void visit_voxels_near(const Grid& grid, const Vec3& p_L, double reach_mm, const Visit& visit) {
  const Vec3 p_V = grid.index_V(p_L);
  std::array<Index, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach_V = reach_mm / grid.spacing_mm[Index(axis)];
    low[axis] = std::max<Index>(std::lround(p_V[Index(axis)] - reach_V), 0);
    high[axis] = std::min(Index(std::lround(p_V[Index(axis)] + reach_V)), grid.size[axis] - 1);
  }
  for (Index k = low[2]; k <= high[2]; ++k)
    for (Index j = low[1]; j <= high[1]; ++j)
      for (Index i = low[0]; i <= high[0]; ++i) visit(i, j, k);
}

}  // namespace lefort::image
