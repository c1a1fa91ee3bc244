/// \file
/// Instruction sets of the inner loops.
#pragma once

#include <cstdint>

namespace lefort::field {

/// Instruction sets that loops are compiled for; all give the same bits.
enum class Simd : std::uint8_t { kBaseline, kAvx2, kAvx512 };

/// \returns the widest instruction set of this processor.
[[nodiscard]] Simd best_simd();

}  // namespace lefort::field
