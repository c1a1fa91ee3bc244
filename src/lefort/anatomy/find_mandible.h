/// \file
/// Segments the mandible.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The voxels of `bone` that are the mandible; empty if the scan does not contain it, or if it
/// cannot be separated from the skull.
///
/// A marker-controlled watershed (\cite vincent1991). Markers are the components of bone that
/// remain after removing voxels of low density and an erosion, from the weakest to the strongest of
/// a list of both. The marker of the mandible is the largest component except the skull that has at
/// least the size, width and depth of a mandible, the height of its rami, and lies as a mandible:
/// as far to the front as the skull (vertebrae do not), in its middle (clavicles do not), and up to
/// it. The hyoid bone is smaller. It and the largest marker, the skull, then grow, thick and dense
/// bone first, so that they meet in the joint and at the occlusion. The result is one component of
/// 10 to 150 ml, teeth included.
///
/// \param ct       the scan.
/// \param bone     all bone, including marrow. \pre on the grid of `ct`.
/// \param bone_hu  threshold of bone.
[[nodiscard]] Mask find_mandible(const image::CtVolume& ct, const Mask& bone, double bone_hu);

}  // namespace lefort::anatomy
