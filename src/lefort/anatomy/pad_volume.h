/// \file
/// Adds voxels around a volume, and removes them.
#pragma once

#include <lefort/core/check.h>
#include <lefort/image/volume.h>

#include <algorithm>
#include <array>

namespace lefort::anatomy {

/// Voxels to add at the first and at the last face of each axis; >= 0.
struct Margin {
  std::array<Index, 3> first{0, 0, 0};
  std::array<Index, 3> last{0, 0, 0};
};

/// The same margin on all six faces.
[[nodiscard]] inline Margin margin_all_around(Index voxels) {
  return {{voxels, voxels, voxels}, {voxels, voxels, voxels}};
}

/// The grid with a margin; voxels keep their positions in L.
[[nodiscard]] inline image::Grid padded(const image::Grid& grid, const Margin& margin) {
  image::Grid wide = grid;
  for (std::size_t axis = 0; axis < 3; ++axis)
    wide.size[axis] += margin.first[axis] + margin.last[axis];
  wide.origin_L =
      grid.point_L({-double(margin.first[0]), -double(margin.first[1]), -double(margin.first[2])});
  return wide;
}

/// The grid without a margin; voxels keep their positions in L.
[[nodiscard]] inline image::Grid cropped(const image::Grid& grid, const Margin& margin) {
  image::Grid inner = grid;
  for (std::size_t axis = 0; axis < 3; ++axis)
    inner.size[axis] -= margin.first[axis] + margin.last[axis];
  inner.origin_L =
      grid.point_L({double(margin.first[0]), double(margin.first[1]), double(margin.first[2])});
  return inner;
}

/// The volume with a margin of constant `value`; voxels keep their positions in L.
///
/// \param volume  any grid.
/// \param margin  voxels to add.
/// \param value   of the added voxels.
template <class T>
[[nodiscard]] image::Volume<T> padded(const image::Volume<T>& volume, const Margin& margin,
                                      const T& value) {
  image::Volume<T> wide{padded(volume.grid, margin), {}};
  wide.values.assign(std::size_t(wide.grid.voxel_count()), value);
  for (Index k = 0; k < volume.grid.size[2]; ++k)
    for (Index j = 0; j < volume.grid.size[1]; ++j)
      for (Index i = 0; i < volume.grid.size[0]; ++i)
        wide.at(i + margin.first[0], j + margin.first[1], k + margin.first[2]) = volume.at(i, j, k);
  return wide;
}

/// Removes a margin.
///
/// \param wide    padded volume.
/// \param margin  of `wide`.
/// \param grid    of the result.
template <class T>
[[nodiscard]] image::Volume<T> cropped(const image::Volume<T>& wide, const Margin& margin,
                                       const image::Grid& grid) {
  image::Volume<T> volume{grid, {}};
  volume.values.reserve(std::size_t(grid.voxel_count()));
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        volume.values.push_back(
            wide.at(i + margin.first[0], j + margin.first[1], k + margin.first[2]));
  return volume;
}

/// Removes a margin; voxels keep their positions in L.
template <class T>
[[nodiscard]] image::Volume<T> cropped(const image::Volume<T>& wide, const Margin& margin) {
  return cropped(wide, margin, cropped(wide.grid, margin));
}

/// Overwrites the voxels that a margin encloses; the voxels of the margin keep their values.
///
/// \param inner   cropped from `wide`.
/// \param margin  of `wide`.
/// \param wide    receives the values of `inner`.
template <class T>
void paste(const image::Volume<T>& inner, const Margin& margin, image::Volume<T>& wide) {
  for (Index k = 0; k < inner.grid.size[2]; ++k)
    for (Index j = 0; j < inner.grid.size[1]; ++j)
      for (Index i = 0; i < inner.grid.size[0]; ++i)
        wide.at(i + margin.first[0], j + margin.first[1], k + margin.first[2]) = inner.at(i, j, k);
}

/// The margin of the grid that lies outside a box: the bounding box of all voxels for which
/// `belongs(offset)` is true, enlarged by `around` voxels on each side. If there are no such
/// voxels, the margin is the whole grid.
template <class Predicate>
[[nodiscard]] Margin margin_around(const image::Grid& grid, const std::array<Index, 3>& around,
                                   const Predicate& belongs) {
  Margin margin{grid.size, {0, 0, 0}};
  std::array<Index, 3> last{-1, -1, -1};
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        if (!belongs(std::size_t(grid.offset(i, j, k)))) continue;
        const std::array<Index, 3> at{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          margin.first[axis] = std::min(margin.first[axis], at[axis]);
          last[axis] = std::max(last[axis], at[axis]);
        }
      }
  if (last[0] < 0) return margin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    margin.first[axis] = std::max<Index>(margin.first[axis] - around[axis], 0);
    margin.last[axis] = std::max<Index>(grid.size[axis] - 1 - last[axis] - around[axis], 0);
  }
  return margin;
}

}  // namespace lefort::anatomy
