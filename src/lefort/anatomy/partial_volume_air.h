/// \file
/// Where air ends at bare bone.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// Voxels between air and bone that air fills by more than half.
///
/// The border of air and bone lies at the middle of their CT numbers, a quarter of a voxel and more
/// beyond the threshold of skin, which leaves these voxels to soft tissue where there is none. Bone
/// is as dense as the densest of the 26 neighbors that belong to it.
///
/// \param air   a set of rooms; \param bone  no voxel of it is air; \pre all lie on one grid.
/// \returns voxels of neither that share a face with one of `air` and at least a corner with bone.
[[nodiscard]] Mask partial_volume_air(const image::CtVolume& ct, const Mask& air, const Mask& bone);

}  // namespace lefort::anatomy
