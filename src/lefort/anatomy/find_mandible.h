/// \file
/// The lower jaw among the bones of a head.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The voxels of `bone` that are the mandible; empty if the scan shows none, or if it hangs
/// together with the skull by more than what is thinner than 2 mm, as where teeth are clenched.
///
/// It is the largest part beside the skull that is as large, as wide and as deep as a jaw and
/// reaches as far to the front as the skull: vertebrae do not, the hyoid bone is smaller.
[[nodiscard]] Mask find_mandible(const Mask& bone);

}  // namespace lefort::anatomy
