/// \file
/// Sign conflicts between neighboring samples.
#pragma once

#include <cmath>

namespace lefort::field {

/// Max difference between lattice neighbors in cells: a distance is 1-Lipschitz; the excess is for
/// rounding.
inline constexpr float kMaxSlope = 1.001F;

/// True if two neighbors cannot belong to one distance field. Beyond the boundary of an open
/// surface, and where triangles are inconsistently oriented, the sign jumps, and with it the
/// distance. False if one of them is NaN.
///
/// \param distance  of one lattice point. \pre both distances are finite or NaN.
/// \param neighbor  distance of an adjacent lattice point.
/// \param cell      spacing of the lattice.
[[nodiscard]] inline bool violates_lipschitz(float distance, float neighbor, float cell) {
  return std::abs(distance - neighbor) > cell * kMaxSlope;
}

}  // namespace lefort::field
