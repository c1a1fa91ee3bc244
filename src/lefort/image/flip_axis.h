/// \file
/// Reverses an axis of a grid without moving anything in the patient.
#pragma once

#include <lefort/core/check.h>
#include <lefort/image/volume.h>

#include <algorithm>

namespace lefort::image {

/// Stores the voxels of `volume` in the opposite order along an axis and reverses that axis of the
/// grid, so that every value stays at its point in L. One reversal makes a left-handed grid
/// right-handed.
///
/// \param volume  changed in place.
/// \param axis    0, 1, 2 for i, j, k.
template <class T>
void flip_axis(Volume<T>& volume, int axis) {
  LEFORT_CHECK(axis >= 0 && axis < 3);
  Grid& grid = volume.grid;
  const auto a = static_cast<std::size_t>(axis);
  const Index n = grid.size[a];
  Index inner = 1;  // Consecutive values with the same index along the axis.
  for (std::size_t b = 0; b < a; ++b) inner *= grid.size[b];
  const Index outer = n == 0 ? 0 : grid.voxel_count() / (inner * n);
  for (Index block = 0; block < outer; ++block) {
    T* const first = volume.values.data() + block * inner * n;
    for (Index lower = 0, upper = n - 1; lower < upper; ++lower, --upper)
      std::swap_ranges(first + lower * inner, first + (lower + 1) * inner, first + upper * inner);
  }
  grid.origin_L += grid.direction.col(axis) * (grid.spacing_mm[axis] * static_cast<double>(n - 1));
  // Subtracted, not negated: zero stays +0, also in files.
  grid.direction.col(axis) = Vec3::Zero() - grid.direction.col(axis);
}

}  // namespace lefort::image
