/// \file
/// Builds a field in bricks: what lefort uses unless asked for one of the paper's methods.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/band_sampler.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/brick_samples.h>

namespace lefort::field {

/// Samples brick by brick and keeps the leaves that the band reaches. Two neighbors that differ by
/// more than a cell, as at the rim of an open surface or where a surface cuts through itself,
/// contradict each other. In their brick the winding number then decides, if there is one; where
/// they still do, both become unknown.
///
/// \param sampler  of `frame`, with a reach of frame.band_mm.
/// \param winding  of the surface, or null if it is open.
/// \returns kCancelled; kInvalidArgument if there are more than 2^32 leaves.
[[nodiscard]] Result<BrickSamples> build_bricks(const BandSampler& sampler, const FieldFrame& frame,
                                                const WindingScanlines* winding,
                                                Progress& progress);

}  // namespace lefort::field
