/// \file
/// Where signed distances contradict each other.
#pragma once

#include <cmath>

namespace lefort::field {

/// The most that neighbors on the lattice may differ, in cells: a distance changes by no more than
/// its argument, but for rounding.
inline constexpr float kMaxSlope = 1.001F;

/// True if two neighbors cannot belong to one distance field. Behind the rim of an open
/// surface, or where triangles turn against each other, the sign jumps and with it the distance.
///
/// False if one of them is NaN.
[[nodiscard]] inline bool violates_lipschitz(float distance, float neighbor, float cell) {
  return std::abs(distance - neighbor) > cell * kMaxSlope;
}

}  // namespace lefort::field
