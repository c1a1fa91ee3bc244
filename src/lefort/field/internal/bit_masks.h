/// \file
/// Masks of 64 bits, one bit per number.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace lefort::field::internal {

/// One bit of each of 64 numbers: the top bit after a shift to the left.
[[nodiscard]] inline std::uint64_t top_bits(std::span<const std::int32_t, 64> numbers, int shift) {
  std::uint64_t bits = 0;
#if defined(__SSE2__)
  for (std::size_t i = 0; i < 64; i += 4) {
    const __m128i four = _mm_slli_epi32(
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(numbers.data() + i)), shift);
    bits |= std::uint64_t(unsigned(_mm_movemask_ps(_mm_castsi128_ps(four)))) << i;
  }
#else
  for (std::size_t i = 0; i < 64; ++i)
    bits |= std::uint64_t(std::uint32_t(numbers[i]) << shift >> 31) << i;
#endif
  return bits;
}

/// One bit per number: set if the number is above `limit`.
[[nodiscard]] inline std::uint64_t bits_above(std::span<const float, 64> numbers, float limit) {
  std::array<std::int32_t, 64> above;
  for (std::size_t i = 0; i < 64; ++i) above[i] = numbers[i] > limit ? -1 : 0;
  return top_bits(above, 0);
}

}  // namespace lefort::field::internal
