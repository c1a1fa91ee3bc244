/// \file
/// The patient's voxels and the bone among them.
#pragma once

#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// What is not air and belongs to the largest thing in the scan; table, pillow and head holder are
/// other things, even where they touch the patient in a narrow place.
[[nodiscard]] Mask find_patient(const image::CtVolume& ct, double skin_hu);

/// The dense parts of the patient that are no islands, and the marrow they enclose.
[[nodiscard]] Mask find_bone(const image::CtVolume& ct, const Mask& patient,
                             const SegmentationOptions& options);

}  // namespace lefort::anatomy
