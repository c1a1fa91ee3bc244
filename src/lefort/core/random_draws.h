/// \file
/// Random numbers from a seeded generator, with the same bits on every machine. The distributions
/// of the standard library are not used, because their numbers depend on the library.
#pragma once

#include <lefort/core/check.h>
#include <lefort/core/types.h>

#include <cstdint>
#include <limits>
#include <random>

namespace lefort {

/// A uniform number of the open interval (0, 1), a multiple of 2^-53.
[[nodiscard]] inline double draw_unit(std::mt19937_64& bits) {
  return (double(bits() >> 12) + 0.5) * 0x1.0p-52;
}

/// A uniform number from 0 to `count` - 1.
///
/// \param count  >= 1.
[[nodiscard]] inline Index draw_below(std::mt19937_64& bits, Index count) {
  LEFORT_CHECK(count >= 1);
  const auto n = std::uint64_t(count);
  const std::uint64_t limit = std::numeric_limits<std::uint64_t>::max() / n * n;
  std::uint64_t drawn = bits();
  while (drawn >= limit) drawn = bits();
  return Index(drawn % n);
}

}  // namespace lefort
