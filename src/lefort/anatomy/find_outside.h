/// \file
/// Where the patient ends and the room begins.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// What is not `patient` and lies around it: what a ball of `nostril_radius_mm` reaches, and every
/// hollow that does not lead deep into the patient.
///
/// The ball comes from all sides but from below, where a head scan cuts through pharynx and
/// trachea.
[[nodiscard]] Mask find_outside(const Mask& patient, double nostril_radius_mm);

}  // namespace lefort::anatomy
