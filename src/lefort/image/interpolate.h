/// \file
/// Trilinear interpolation of a volume.
#pragma once

#include <lefort/image/volume.h>

#include <algorithm>
#include <array>

namespace lefort::image {

namespace internal {

/// The eight voxels around a point: offset of the lower corner, step to the upper one along each
/// axis (0 at the upper border), and position of the point between them, 0 to 1.
struct Cell {
  Index offset;
  std::array<Index, 3> step;
  Vec3 fraction;
};

/// Finds the cell of a point.
///
/// A voxel extends half a spacing from its center. Beyond the outermost centers the coordinate is
/// clamped to them: the value is constant along that axis.
///
/// \returns false if the point is outside of all voxels, or not finite.
[[nodiscard]] inline bool find_cell(const Grid& grid, const Vec3& p_L, Cell& cell) {
  const Vec3 p_V = grid.index_V(p_L);
  const std::array<Index, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  cell.offset = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double last = static_cast<double>(grid.size[a] - 1);
    // Written so that NaN, and any point of a grid without voxels, is outside.
    if (!(p_V[axis] >= -0.5 && p_V[axis] < last + 0.5)) return false;
    const double clamped = std::clamp(p_V[axis], 0.0, last);
    const auto lower = static_cast<Index>(clamped);
    cell.offset += lower * stride[a];
    cell.step[a] = lower + 1 < grid.size[a] ? stride[a] : 0;
    cell.fraction[axis] = clamped - static_cast<double>(lower);
  }
  return true;
}

}  // namespace internal

/// The value of `volume` at a point: continuous inside the grid, and exact for linear functions
/// between the outermost centers.
///
/// \param volume   the values.
/// \param p_L      the point [mm].
/// \param outside  value outside of all voxels.
template <class T>
[[nodiscard]] double interpolate(const Volume<T>& volume, const Vec3& p_L, double outside) {
  internal::Cell cell;
  if (!internal::find_cell(volume.grid, p_L, cell)) return outside;
  const T* const corner = volume.values.data() + cell.offset;
  const auto [dx, dy, dz] = cell.step;
  const auto along_x = [&, dx = dx](const T* v) {
    return static_cast<double>(v[0]) * (1.0 - cell.fraction.x()) +
           static_cast<double>(v[dx]) * cell.fraction.x();
  };
  const auto along_xy = [&, dy = dy](const T* v) {
    return along_x(v) * (1.0 - cell.fraction.y()) + along_x(v + dy) * cell.fraction.y();
  };
  return along_xy(corner) * (1.0 - cell.fraction.z()) + along_xy(corner + dz) * cell.fraction.z();
}

}  // namespace lefort::image
