/// \file
/// The samples around a query point, independent of the storage format.
#pragma once

#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <array>
#include <cmath>
#include <limits>

namespace lefort::field {

/// A cube of lattice cells with the distances [mm] at its corners, x fastest: beyond the band
/// +infinity outside the surface and -infinity inside it; NaN if unknown.
struct CellSamples {
  LatticePoint low;  ///< Lowest corner.
  int cells;         ///< Cells along an edge.
  std::array<float, 8> corners;
};

/// kBand if all corners are finite; otherwise the common zone of those that are not, or kUnknown if
/// they differ.
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

/// The value that represents a zone without distances: +-infinity, or NaN.
[[nodiscard]] inline float zone_value(Zone zone) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (zone == Zone::kUnknown) return std::numeric_limits<float>::quiet_NaN();
  return zone == Zone::kInside ? -kInfinity : kInfinity;
}

}  // namespace lefort::field
