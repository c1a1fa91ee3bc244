/// \file
/// Distances in bricks for processors with AVX-512.
#pragma once

#include <lefort/field/field_frame.h>
#include <lefort/field/storage/brick_samples.h>

#include <span>

namespace lefort::field::internal {

/// True if distances_avx512() can address all samples: it uses 31 bits for byte offsets and eleven
/// for cells, and reads the first leaf in place of leaves that are not stored; so one leaf must be
/// stored.
[[nodiscard]] bool fits_avx512(const BrickSamples& samples);

/// The same as distances_in_bricks(), with the same bits. \pre fits_avx512().
void distances_avx512(const BrickSamples& samples, const FieldFrame& frame,
                      std::span<const Vec3> p_B, std::span<float> distances_mm);

}  // namespace lefort::field::internal
