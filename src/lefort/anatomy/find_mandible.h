/// \file
/// Segments the mandible.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The voxels of `bone` that are the mandible; empty if the scan does not contain it, or if it
/// cannot be separated from the skull.
///
/// If a connected component of bone has size and position of a mandible, that is the result.
/// Otherwise: a marker-controlled watershed (\cite vincent1991). Voxels of low density are removed
/// and the rest is eroded, both in steps from weak to strong, until a component has size and
/// position of a mandible. The largest of these, except the skull, is the marker of the mandible:
///
///   - size: at least the volume, width and depth of a mandible. After more than the weakest
///     erosion, also the height of the rami. The hyoid bone is smaller.
///   - position: below the center of the skull and up to it; in its middle (clavicles are not); its
///     front in the anterior part of the length of the skull (vertebrae lie behind it).
///
/// This marker and the largest one, the skull, then grow, thick and dense bone first, so that they
/// meet in the temporomandibular joint and at the occlusion. The result is one component of 10 to
/// 150 ml, teeth included.
///
/// \param ct       the scan.
/// \param bone     all bone, including marrow. \pre on the grid of `ct`.
/// \param bone_hu  threshold of bone.
[[nodiscard]] Mask find_mandible(const image::CtVolume& ct, const Mask& bone, double bone_hu);

}  // namespace lefort::anatomy
