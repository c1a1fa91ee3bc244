/// \file
/// Classifies the air inside the patient as airway or sinuses.
#pragma once

#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// Two disjoint sets.
struct AirSpaces {
  Mask airway;
  Mask sinus;
};

/// Divides the air inside the patient at its narrow passages into rooms. A room is a sinus if at
/// least 70 % of its walls are bony and it does not touch the outside. All other rooms are airway,
/// except connected pockets of less than `min_air_ml` that do not touch the outside.
///
/// \param air      air inside the patient.
/// \param bone     including marrow.
/// \param outside  background; see find_outside.h.
/// \param options  radius of ostia and smallest volume.
[[nodiscard]] AirSpaces find_air_spaces(const Mask& air, const Mask& bone, const Mask& outside,
                                        const SegmentationOptions& options);

}  // namespace lefort::anatomy
