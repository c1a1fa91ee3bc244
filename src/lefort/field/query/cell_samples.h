/// \file
/// The samples that a query lies between, whatever keeps them.
#pragma once

#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <array>
#include <cmath>
#include <limits>

namespace lefort::field {

/// A cube of lattice cells and the distances [mm] at its corners, x fastest: +infinity beyond the
/// band outside, -infinity inside, NaN where that is not known.
struct CellSamples {
  LatticePoint low;  ///< Lowest corner.
  int cells;         ///< Edge in lattice cells.
  std::array<float, 8> corners;
};

/// kBand if all corners are finite; else where those lie that are not.
[[nodiscard]] inline Zone zone_of(const std::array<float, 8>& corners) {
  bool outside = false, inside = false, unknown = false;
  for (const float d : corners) {
    unknown = unknown || std::isnan(d);
    if (std::isinf(d)) (d > 0.0F ? outside : inside) = true;
  }
  if (unknown || (outside && inside)) return Zone::kUnknown;
  if (outside) return Zone::kOutside;
  return inside ? Zone::kInside : Zone::kBand;
}

/// What stands for a side in place of a distance: +-infinity, or NaN.
[[nodiscard]] inline float side_value(Zone zone) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (zone == Zone::kUnknown) return std::numeric_limits<float>::quiet_NaN();
  return zone == Zone::kInside ? -kInfinity : kInfinity;
}

}  // namespace lefort::field
