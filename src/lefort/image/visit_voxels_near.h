/// \file
/// The voxels near a point.
#pragma once

#include <lefort/image/volume.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lefort::image {

/// Calls visit(i, j, k), i fastest, for each voxel that overlaps a box around a point. The edges of
/// the box are parallel to the axes of the grid.
///
/// \param grid             the voxels.
/// \param p_L              center of the box [mm].
/// \param max_distance_mm  half of the width of the box along each axis.
/// \param visit            called in the order of the values.
template <class Visit>
void visit_voxels_near(const Grid& grid, const Vec3& p_L, double max_distance_mm,
                       const Visit& visit) {
  const Vec3 p_V = grid.index_V(p_L);
  std::array<Index, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double distance_V = max_distance_mm / grid.spacing_mm[Index(axis)];
    low[axis] = std::max<Index>(std::lround(p_V[Index(axis)] - distance_V), 0);
    high[axis] = std::min(Index(std::lround(p_V[Index(axis)] + distance_V)), grid.size[axis] - 1);
  }
  for (Index k = low[2]; k <= high[2]; ++k)
    for (Index j = low[1]; j <= high[1]; ++j)
      for (Index i = low[0]; i <= high[0]; ++i) visit(i, j, k);
}

}  // namespace lefort::image
