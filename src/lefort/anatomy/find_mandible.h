/// \file
/// Segments the mandible.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The voxels of `bone` that are the mandible; empty if the scan does not contain it, or if it is
/// connected with the skull by a bridge thicker than 2 mm, as with clenched teeth.
///
/// It is the largest component except the skull that has at least the size, width and depth of a
/// mandible and reaches as far to the front as the skull. Vertebrae do not, and the hyoid bone is
/// smaller.
///
/// \param bone  all bone, including marrow.
[[nodiscard]] Mask find_mandible(const Mask& bone);

}  // namespace lefort::anatomy
