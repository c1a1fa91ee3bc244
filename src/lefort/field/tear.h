/// \file
/// Where signed distances contradict each other.
#pragma once

#include <cmath>

namespace lefort::field {

/// True if two neighbours on the lattice cannot belong to one distance field, which changes by at
/// most one cell from point to point. Behind the rim of an open surface, or where triangles turn
/// against each other, the sign jumps and with it the distance.
[[nodiscard]] inline bool is_torn(double distance, double neighbour, double cell) {
  return !(std::abs(distance - neighbour) <= cell * 1.001);
}

}  // namespace lefort::field
