/// \file
/// Sets of voxels and what morphology does with them, lengths in mm.
///
/// Distances run between voxel centers. Beyond the grid there are neither voxels of a set nor
/// others. So the faces of the grid do not erode a set, but closing fills narrow gaps between a set
/// and a face.
#pragma once

#include <lefort/core/parallel.h>
#include <lefort/image/volume.h>

#include <array>
#include <cstdint>
#include <vector>

namespace lefort::anatomy {

/// 1 for the voxels of the set, 0 for the others.
using Mask = image::Volume<std::uint8_t>;

/// The set of the voxels, given by offset, for which `belongs` holds.
template <class Predicate>
[[nodiscard]] Mask mask_where(const image::Grid& grid, const Predicate& belongs) {
  Mask mask{grid, std::vector<std::uint8_t>(std::size_t(grid.voxel_count()))};
  parallel_for(
      grid.voxel_count(),
      [&](Index v) { mask.values[std::size_t(v)] = belongs(std::size_t(v)) ? 1 : 0; }, 65536);
  return mask;
}

/// Calls body(offset of the first voxel, offset from voxel to voxel) for every line of voxels along
/// an axis, in any order.
template <class Body>
void for_each_line(const image::Grid& grid, std::size_t axis, const Body& body) {
  const std::array<Index, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  const std::size_t fast = axis == 0 ? 1 : 0;
  const std::size_t slow = axis == 2 ? 1 : 2;
  parallel_for(grid.size[fast] * grid.size[slow], [&](Index line) {
    const Index start =
        line % grid.size[fast] * stride[fast] + line / grid.size[fast] * stride[slow];
    body(start, stride[axis]);
  });
}

[[nodiscard]] Index voxel_count(const Mask& mask);

/// Volume of one voxel.
[[nodiscard]] double voxel_ml(const image::Grid& grid);

/// How far the nearest voxel of the set is [mm]; 0 in the set, 1e6 everywhere if it is empty.
[[nodiscard]] image::ScalarVolume distance_to(const Mask& mask);

/// Voxels within `radius_mm` of the set.
[[nodiscard]] Mask dilated(const Mask& mask, double radius_mm);

/// Voxels of the set further than `radius_mm` from all others.
[[nodiscard]] Mask eroded(const Mask& mask, double radius_mm);

/// Eroded, then dilated: without what is thinner than twice the radius.
[[nodiscard]] Mask opened(const Mask& mask, double radius_mm);

/// Dilated, then eroded: with the gaps filled that are narrower than twice the radius.
[[nodiscard]] Mask closed(const Mask& mask, double radius_mm);

/// The set, the voxels within `distance_mm` of it, and those that share a face with one of it,
/// however far voxels are apart.
[[nodiscard]] Mask dilated_by_one_voxel_or_more(const Mask& mask, double distance_mm);

enum class Neighbors { kFaces, kFacesEdgesCorners };

/// The connected parts of a set, numbered from 1 in the order of their first voxel.
struct Parts {
  image::Volume<std::int32_t> part_of;  ///< 0 outside the set.
  std::vector<Index> voxels;            ///< Of part p at [p]; [0] counts the voxels outside.

  [[nodiscard]] std::int32_t count() const { return std::int32_t(voxels.size()) - 1; }
  /// The part of most voxels, the first of equals; 0 if there is none.
  [[nodiscard]] std::int32_t largest() const;
};

[[nodiscard]] Parts connected_parts(const Mask& mask, Neighbors neighbors);

/// The voxels of the parts for which keep[part] holds; keep[0] speaks for the voxels outside.
[[nodiscard]] Mask select_labels(const Parts& parts, const std::vector<std::uint8_t>& keep);

/// For every part, whether a voxel of it lies in `mask`; entry 0 is 0.
[[nodiscard]] std::vector<std::uint8_t> labels_touching(const Parts& parts, const Mask& mask);

/// Convolved with a Gaussian whose sigma along i, j, k is `sigma_mm`; values beyond the grid repeat
/// its faces. \pre sigma_mm >= 0.
[[nodiscard]] image::ScalarVolume smoothed(image::ScalarVolume values, const Vec3& sigma_mm);
/// The same sigma in all directions.
[[nodiscard]] image::ScalarVolume smoothed(image::ScalarVolume values, double sigma_mm);

}  // namespace lefort::anatomy
