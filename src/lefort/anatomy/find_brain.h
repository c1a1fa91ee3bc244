/// \file
/// Segments the content of the cranial cavity.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The soft tissue inside the skull, up to the narrowest cross-section of each opening; empty if
/// the scan contains no cranial cavity.
///
/// \param soft     soft tissue: neither bone nor air.
/// \param bone     the walls, including marrow.
/// \param outside  background.
[[nodiscard]] Mask find_brain(const Mask& soft, const Mask& bone, const Mask& outside);

}  // namespace lefort::anatomy
