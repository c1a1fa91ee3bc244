/// \file
/// The content of the cranial cavity.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The soft tissue inside the skull, up to the narrowest place of every opening; empty if the scan
/// shows no cranial cavity.
///
/// \param soft  what is neither bone nor air.
/// \param bone  the walls, with the marrow.
/// \param outside  what is not the patient.
[[nodiscard]] Mask find_brain(const Mask& soft, const Mask& bone, const Mask& outside);

}  // namespace lefort::anatomy
