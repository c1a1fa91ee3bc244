/// \file
/// Sets of voxels, and morphological operations with lengths in mm.
///
/// Distances are between voxel centers. Nothing is assumed about voxels beyond the grid: erosion
/// does not start at the faces of the grid, and therefore closing also fills narrow gaps between a
/// set and a face.
#pragma once

#include <lefort/core/parallel.h>
#include <lefort/image/volume.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace lefort::anatomy {

/// 1 for voxels of the set, 0 for others.
using Mask = image::Volume<std::uint8_t>;

/// The set of voxels, given by offset, for which `belongs` is true.
///
/// \param grid     of the set.
/// \param belongs  belongs(offset), called concurrently.
template <class Predicate>
[[nodiscard]] Mask mask_where(const image::Grid& grid, const Predicate& belongs) {
  Mask mask{grid, std::vector<std::uint8_t>(std::size_t(grid.voxel_count()))};
  parallel_for(
      grid.voxel_count(),
      [&](Index v) { mask.values[std::size_t(v)] = belongs(std::size_t(v)) ? 1 : 0; }, 65536);
  return mask;
}

/// Calls body(offset of the first voxel, stride) for each line of voxels along an axis, in any
/// order.
///
/// \param grid  the voxels.
/// \param axis  0, 1, 2 for i, j, k.
/// \param body  called concurrently.
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

/// Number of voxels of the set.
[[nodiscard]] Index voxel_count(const Mask& mask);

/// Volume of one voxel.
[[nodiscard]] double voxel_ml(const image::Grid& grid);

/// \param mask    a set.
/// \param max_mm  largest distance that is needed, >= 0; a small one is faster.
/// \returns the distance of each voxel to the closest voxel of the set [mm], 0 in the set. Those
///   above max_mm may be too large, but not too small; 1e6 everywhere if the set is empty.
[[nodiscard]] image::ScalarVolume distance_to(
    const Mask& mask, double max_mm = std::numeric_limits<double>::infinity());

/// All voxels within `radius_mm` of the set.
///
/// \param mask       a set.
/// \param radius_mm  >= 0.
[[nodiscard]] Mask dilated(const Mask& mask, double radius_mm);

/// Voxels of the set that are further than `radius_mm` from every voxel outside the set.
[[nodiscard]] Mask eroded(const Mask& mask, double radius_mm);

/// Erosion, then dilation: removes what is thinner than twice the radius.
[[nodiscard]] Mask opened(const Mask& mask, double radius_mm);

/// Dilation, then erosion: fills gaps narrower than twice the radius.
[[nodiscard]] Mask closed(const Mask& mask, double radius_mm);

/// The set, the voxels within `distance_mm` of it, and in any case the voxels that share a face
/// with it.
[[nodiscard]] Mask dilated_by_one_voxel_or_more(const Mask& mask, double distance_mm);

/// Adjacency of voxels: common faces only (6), or common faces, edges or corners (26).
enum class Neighbors { kFaces, kFacesEdgesCorners };

/// Connected components of a set, numbered from 1 in the order of their first voxels.
struct Components {
  image::Volume<std::int32_t> component_of;  ///< 0 outside the set.
  /// Number of voxels of each component; [0] counts those outside the set.
  std::vector<Index> voxels;

  [[nodiscard]] std::int32_t count() const { return std::int32_t(voxels.size()) - 1; }
  /// The component with the most voxels, the first if several have; 0 if there is none.
  [[nodiscard]] std::int32_t largest() const;
};

/// Finds the connected components of a set.
///
/// \param mask       a set.
/// \param neighbors  which voxels are adjacent.
[[nodiscard]] Components connected_components(const Mask& mask, Neighbors neighbors);

/// The voxels of the components for which keep[component] is true; keep[0] applies outside the set.
[[nodiscard]] Mask select_components(const Components& components,
                                     const std::vector<std::uint8_t>& keep);

/// For each component, whether one of its voxels is in `mask`; entry 0 is 0.
[[nodiscard]] std::vector<std::uint8_t> components_overlapping(const Components& components,
                                                               const Mask& mask);

/// Convolution with a Gaussian; values outside of the grid repeat those of its faces.
///
/// \param values    on any grid.
/// \param sigma_mm  along i, j, k. \pre >= 0.
[[nodiscard]] image::ScalarVolume smoothed(image::ScalarVolume values, const Vec3& sigma_mm);
/// The same sigma along all axes.
[[nodiscard]] image::ScalarVolume smoothed(image::ScalarVolume values, double sigma_mm);

}  // namespace lefort::anatomy
