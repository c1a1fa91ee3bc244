/// \file
/// Segments the air around the patient.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The air around the patient: all voxels that a ball of `nostril_radius_mm` can cover when it
/// moves in from outside, and all cavities that open to this air and are at most 12 mm deep, such
/// as the concha of the ear. The ball enters from all sides except from inferior, where a head scan
/// truncates pharynx and trachea.
///
/// \param patient            see find_patient().
/// \param nostril_radius_mm  radius of the ball.
[[nodiscard]] Mask find_outside(const Mask& patient, double nostril_radius_mm);

}  // namespace lefort::anatomy
