/// \file
/// Segments the patient, and bone.
#pragma once

#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The voxels of the largest object in the scan. Table, pillow and head holder are other objects,
/// even if they touch the patient over a small area.
///
/// \param ct       the scan.
/// \param skin_hu  voxels below this CT number are air.
[[nodiscard]] Mask find_patient(const image::CtVolume& ct, double skin_hu);

/// The dense components of the patient that are not islands, and the marrow they enclose.
///
/// \param ct       the scan.
/// \param patient  from find_patient().
/// \param options  thresholds and smallest volume.
[[nodiscard]] Mask find_bone(const image::CtVolume& ct, const Mask& patient,
                             const SegmentationOptions& options);

}  // namespace lefort::anatomy
