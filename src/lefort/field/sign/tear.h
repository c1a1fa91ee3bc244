/// \file
/// Where signed distances contradict each other.
#pragma once

#include <cmath>

namespace lefort::field {

/// The most that neighbours on the lattice may differ, in cells: a distance changes by no more than
/// its argument, but for rounding.
inline constexpr float kTearCells = 1.001F;

/// True if two neighbours cannot belong to one distance field. Behind the rim of an open
/// surface, or where triangles turn against each other, the sign jumps and with it the distance.
///
/// False if one of them is NaN.
[[nodiscard]] inline bool is_torn(float distance, float neighbour, float cell) {
  return std::abs(distance - neighbour) > cell * kTearCells;
}

}  // namespace lefort::field
