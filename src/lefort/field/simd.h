/// \file
/// Which instructions the innermost loops may use.
#pragma once

#include <cstdint>

namespace lefort::field {

/// Instruction sets the loops are compiled for; all give the same bits.
enum class Simd : std::uint8_t { kBaseline, kAvx2, kAvx512 };

/// The best that this processor has.
[[nodiscard]] Simd best_simd();

}  // namespace lefort::field
