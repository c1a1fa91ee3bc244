/// \file
/// The lattice of a distance field, and the width of its band.
#pragma once

#include <lefort/core/types.h>

#include <numbers>

namespace lefort::field {

/// Parameters of a field, and its position.
struct FieldFrame {
  Vec3 origin_B = Vec3::Zero();  ///< Lowest corner of the cube, and first sample.
  double cell_mm = 0.0;          ///< Spacing of the samples.
  int resolution = 0;            ///< Cells along an edge of the cube, a power of two.
  double band_mm = 0.0;          ///< Samples closer to the surface than this are known.
  double tolerance_mm = 0.0;     ///< Octrees reproduce known samples within this.
  bool closed = false;           ///< The surface is closed: zones beyond the band are known.

  /// Every point up to this distance from the surface lies between known samples, except where
  /// signs are in conflict.
  [[nodiscard]] double guaranteed_mm() const { return band_mm - std::numbers::sqrt3 * cell_mm; }
};

}  // namespace lefort::field
