/// \file
/// Distances in bricks for processors with AVX-512.
#pragma once

#include <lefort/field/field_frame.h>
#include <lefort/field/storage/brick_samples.h>

#include <span>

namespace lefort::field::internal {

/// Whether distances_avx512() can address all samples: it counts their bytes in 31 bits and cells
/// in eleven, and reads some leaf for those that are not stored.
[[nodiscard]] bool fits_avx512(const BrickSamples& samples);

/// distances_in_bricks() by other means, with the same bits. \pre fits_avx512().
void distances_avx512(const BrickSamples& samples, const FieldFrame& frame,
                      std::span<const Vec3> p_B, std::span<float> distances_mm);

}  // namespace lefort::field::internal
