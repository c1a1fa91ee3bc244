/// \file
/// Interpolates in bricks, many points at a time.
#pragma once

#include <lefort/field/field_frame.h>
#include <lefort/field/field_sample.h>
#include <lefort/field/simd.h>
#include <lefort/field/storage/brick_samples.h>

#include <span>

namespace lefort::field {

/// Trilinear between the eight samples around each point. The memory that later points need is
/// fetched while earlier ones are worked on.
///
/// \pre as many results as points.
void sample_bricks(const BrickSamples& samples, const FieldFrame& frame, std::span<const Vec3> p_B,
                   std::span<FieldSample> results, Simd simd = best_simd());

/// The same without gradients: distances [mm], +-infinity beyond the band, NaN where unknown.
void distances_in_bricks(const BrickSamples& samples, const FieldFrame& frame,
                         std::span<const Vec3> p_B, std::span<float> distances_mm,
                         Simd simd = best_simd());

}  // namespace lefort::field
