/// \file
/// Interpolation in bricks for several points at a time.
#pragma once

#include <lefort/field/field_frame.h>
#include <lefort/field/field_sample.h>
#include <lefort/field/simd.h>
#include <lefort/field/storage/brick_samples.h>

#include <span>

namespace lefort::field {

/// Interpolates trilinearly between the eight samples around each point. Prefetches samples.
///
/// \param samples  of the field.
/// \param frame    its lattice.
/// \param p_B      query points [mm].
/// \param results  \pre as many as points.
/// \param simd     instruction set; all give the same bits.
void sample_bricks(const BrickSamples& samples, const FieldFrame& frame, std::span<const Vec3> p_B,
                   std::span<FieldSample> results, Simd simd = best_simd());

/// The same without gradients: distances [mm]; beyond the band +infinity outside the surface and
/// -infinity inside it; NaN if unknown.
///
/// \param samples       of the field.
/// \param frame         its lattice.
/// \param p_B           query points [mm].
/// \param distances_mm  \pre as many as points.
/// \param simd          instruction set; all give the same bits.
void distances_in_bricks(const BrickSamples& samples, const FieldFrame& frame,
                         std::span<const Vec3> p_B, std::span<float> distances_mm,
                         Simd simd = best_simd());

}  // namespace lefort::field
