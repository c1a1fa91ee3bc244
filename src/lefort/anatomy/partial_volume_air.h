/// \file
/// Partial-volume voxels between air and bone.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// Voxels between air and bone that are more than half filled with air.
///
/// The border between air and bone is where the CT number is the mean of both, a quarter of a voxel
/// or more beyond the point where it exceeds the threshold of skin. That threshold therefore labels
/// these voxels as soft tissue, although there is none. The CT number of bone is that of the
/// densest bone voxel among the 26 neighbors.
///
/// \param ct    the scan.
/// \param air   airway or sinuses.
/// \param bone  disjoint from `air`. \pre all are on one grid.
/// \returns voxels of neither set that share a face with `air` and at least a corner with `bone`.
[[nodiscard]] Mask partial_volume_air(const image::CtVolume& ct, const Mask& air, const Mask& bone);

}  // namespace lefort::anatomy
