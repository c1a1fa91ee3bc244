/// \file
/// The space that an arch needs while a splint is put on.
#pragma once

#include <lefort/core/progress.h>
#include <lefort/dental/measure_occlusion.h>
#include <lefort/geometry/bvh.h>
#include <lefort/image/volume.h>

#include <vector>

namespace lefort::dental {

/// An arch with its clearance, and all that lies behind it, on a grid whose k axis is the direction
/// of insertion.
struct BlockedSpace {
  /// Positive inside [mm]; near the border the distance to it, at most kBand_mm.
  image::ScalarVolume level;
  /// For each column of the grid (i fastest): the height above k = 0 [mm] where the arch begins, as
  /// seen from the other arch; NaN where it has nothing.
  std::vector<double> border_mm;
};

/// \param arch          the surface, outward.
/// \param grid          of the result.
/// \param is_upper      whether the arch lies towards growing k.
/// \param clearance_mm  added to the arch.
[[nodiscard]] BlockedSpace block_space(const geometry::Bvh& arch, const image::Grid& grid,
                                       bool is_upper, double clearance_mm);

}  // namespace lefort::dental
