/// \file
/// The paper's step 4: the regular samples become an octree, and cells are united from the smallest
/// up while they can be reconstructed.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/sign/outside_band.h>
#include <lefort/field/storage/octree.h>

namespace lefort::field {

/// Unites eight sibling leaves when every lattice sample in them is reproduced by trilinear
/// interpolation from the corners of their parent, within the tolerance of `frame`.
///
/// Each test looks at all samples of the finest lattice inside the parent, not at the corners of
/// its children alone. So errors do not add up from level to level: the finished tree reproduces
/// every sample within the tolerance.
///
/// \returns kCancelled.
[[nodiscard]] Result<Octree> coalesce(const SignedDistances& distances, const FieldFrame& frame,
                                      Progress& progress);

}  // namespace lefort::field
