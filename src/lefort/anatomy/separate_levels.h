/// \file
/// Separates the surfaces of two labels.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// Half the width of the gap that separate_levels() leaves between two labels that touch.
inline constexpr double kHalfGap_voxels = 0.625;

/// Reduces the level-set functions of two labels so that their zero surfaces share no voxel cell
/// and leave a gap of about 2 kHalfGap_voxels, halfway between the labels.
///
/// The side of a point is half the difference of its signed distances to both labels, in voxels:
/// zero halfway between them and positive on the side of the first. Each function is limited to the
/// side (for the second label with its sign reversed) minus half the gap, so surfaces with a larger
/// gap do not change. Afterwards a voxel
/// that is inside the second label and has one inside the first among its 26 neighbors is set
/// outside: no cell of eight voxels contains both, hence no triangle connects them.
///
/// \param in_first, in_second  the voxels of the labels. \pre disjoint, on one grid.
/// \param first_mm, second_mm  changed; positive inside, on the grid of the labels.
void separate_levels(const Mask& in_first, const Mask& in_second, image::ScalarVolume& first_mm,
                     image::ScalarVolume& second_mm);

}  // namespace lefort::anatomy
