/// \file
/// Values on a regular, possibly oblique grid of voxels, with the map from voxel indices V to the
/// patient frame L.
#pragma once

#include <lefort/core/types.h>

#include <array>
#include <cstdint>
#include <vector>

namespace lefort::image {

/// Positions of the voxel centers: p_L = origin_L + direction * (index .* spacing).
struct Grid {
  std::array<Index, 3> size{0, 0, 0};  ///< Voxels along i, j, k.
  Vec3 spacing_mm{1.0, 1.0, 1.0};      ///< > 0.
  Vec3 origin_L{0.0, 0.0, 0.0};        ///< Center of voxel (0, 0, 0).
  Mat3 direction = Mat3::Identity();   ///< Columns: unit vectors of i, j, k in L; a rotation.

  [[nodiscard]] Index voxel_count() const { return size[0] * size[1] * size[2]; }
  /// Position of a voxel in the list of values; i runs fastest.
  [[nodiscard]] Index offset(Index i, Index j, Index k) const {
    return i + size[0] * (j + size[1] * k);
  }
  [[nodiscard]] bool contains(Index i, Index j, Index k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
  }
  [[nodiscard]] Vec3 point_L(const Vec3& index_V) const {
    return origin_L + direction * index_V.cwiseProduct(spacing_mm);
  }
  /// Center of the voxel at a position in the list of values.
  [[nodiscard]] Vec3 center_L(Index offset) const {
    const Index row = offset / size[0], i = offset % size[0], j = row % size[1], k = row / size[1];
    return point_L({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
  }
  [[nodiscard]] Vec3 index_V(const Vec3& p_L) const {
    return (direction.transpose() * (p_L - origin_L)).cwiseQuotient(spacing_mm);
  }
  bool operator==(const Grid&) const = default;
};

/// A grid and one value per voxel, i fastest.
template <class T>
struct Volume {
  Grid grid;
  std::vector<T> values;

  [[nodiscard]] const T& at(Index i, Index j, Index k) const {
    return values[std::size_t(grid.offset(i, j, k))];
  }
  [[nodiscard]] T& at(Index i, Index j, Index k) {
    return values[std::size_t(grid.offset(i, j, k))];
  }
};

/// CT numbers in Hounsfield units.
using CtVolume = Volume<std::int16_t>;

/// Any real-valued quantity per voxel.
using ScalarVolume = Volume<float>;

}  // namespace lefort::image
