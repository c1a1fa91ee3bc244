/// \file
/// The space that an arch needs while a splint is put on.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/bvh.h>
#include <lefort/image/volume.h>

#include <vector>

namespace lefort::dental {

/// An arch that has grown by a clearance, and all that lies behind it, on a grid whose k axis is
/// the direction of insertion.
struct BlockedSpace {
  /// Positive inside [mm]. Near the border, up to 1 mm, the distance to it.
  image::ScalarVolume level;
  /// For each column of the grid (i fastest): the height above k = 0 [mm] where the blocked space
  /// begins, as seen from the other arch; NaN where the arch has nothing.
  std::vector<double> border_mm;
};

/// \param direction  columns: unit vectors of i, j, k in L; a rotation.
/// \param box        of the grid, along these directions [mm].
/// \returns the grid; or kInvalidArgument if it would have more than 10^8 voxels.
[[nodiscard]] Result<image::Grid> grid_in_box(const Mat3& direction, const Box3& box,
                                              double voxel_mm);

/// \param arch          the surface, outward.
/// \param grid          of the result.
/// \param is_upper      whether the arch lies towards growing k.
/// \param clearance_mm  by which the arch grows.
/// \param progress      may cancel; the result then is not complete.
[[nodiscard]] BlockedSpace block_space(const geometry::Bvh& arch, const image::Grid& grid,
                                       bool is_upper, double clearance_mm,
                                       const Progress& progress = Progress::none());

}  // namespace lefort::dental
