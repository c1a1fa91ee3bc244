/// \file
/// The air inside the patient: airway and sinuses.
#pragma once

#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// Two sets without common voxels.
struct AirSpaces {
  Mask airway;
  Mask sinus;
};

/// Divides `air`, the air inside the patient, at its narrow places into rooms. A room whose walls
/// are nearly all bony is a sinus; every other is airway, small pockets in soft tissue excepted.
///
/// \param air      neither patient nor outside.
/// \param bone     with the marrow.
/// \param outside  what lies around the patient; see find_outside.
[[nodiscard]] AirSpaces find_air_spaces(const Mask& air, const Mask& bone, const Mask& outside,
                                        const SegmentationOptions& options);

}  // namespace lefort::anatomy
