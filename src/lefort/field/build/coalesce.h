/// \file
/// Builds an octree from lattice samples, bottom-up (paper, section 2.1, step 4).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/sign/outside_band.h>
#include <lefort/field/storage/octree.h>

namespace lefort::field {

/// Merges eight sibling leaves if all are beyond the band in the same zone, or if all are in the
/// band and trilinear interpolation from the corners of their parent reproduces every lattice
/// sample in the parent within the tolerance of `frame`.
///
/// Each test uses all samples of the finest lattice in the parent, not only the corners of its
/// children. So errors do not accumulate over levels: the final tree reproduces every sample within
/// the tolerance.
///
/// \param distances  of all lattice points.
/// \param frame      lattice of the field.
/// \param progress   may cancel.
/// \returns the octree, or kCancelled.
[[nodiscard]] Result<Octree> coalesce(const SignedDistances& distances, const FieldFrame& frame,
                                      Progress& progress);

}  // namespace lefort::field
