/// \file
/// Instruction sets of the inner loops.
#pragma once

#include <cstdint>

namespace lefort::field {

/// Instruction sets that loops are compiled for; all give the same bits. kBaseline: that of the
/// compiler's default target, for x86-64 processors without AVX2 and for all other architectures.
enum class Simd : std::uint8_t { kBaseline, kAvx2, kAvx512 };

/// \returns the widest instruction set of this processor.
[[nodiscard]] Simd best_simd();

}  // namespace lefort::field
