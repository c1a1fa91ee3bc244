/// \file
/// Builds a field in bricks, the default method.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/band_sampler.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/brick_samples.h>

namespace lefort::field {

/// Samples the bricks of the band, and stores their leaves that contain distances.
///
/// Two neighbors whose distances differ by more than a cell are in conflict, as at the boundary of
/// an open surface or where a surface intersects itself. Inside a brick the winding number resolves
/// conflicts, if it is known; samples of remaining conflicts become unknown.
///
/// \param sampler   of `frame`, with frame.band_mm or, with `wide`, a larger distance.
/// \param frame     lattice of the field.
/// \param winding   of the surface, or null if it is open.
/// \param wide      null, or a lattice of the sampler's bricks: receives all samples of the
///   sampler, as sample_narrow_band() has them.
/// \param progress  receives the fraction done; may cancel.
/// \returns the samples; kCancelled; or kInvalidArgument if there are more than 2^32 leaves.
[[nodiscard]] Result<BrickSamples> build_bricks(const BandSampler& sampler, const FieldFrame& frame,
                                                const WindingScanlines* winding,
                                                SparseLattice* wide, Progress& progress);

}  // namespace lefort::field
