/// \file
/// Where the samples of a distance field lie, and how far from the surface they reach.
#pragma once

#include <lefort/core/types.h>

#include <numbers>

namespace lefort::field {

/// What a field was made with, and where it lies.
struct FieldFrame {
  Vec3 origin_B = Vec3::Zero();  ///< Lowest corner of the cube, and first sample.
  double cell_mm = 0.0;          ///< Spacing of the samples.
  int resolution = 0;            ///< Cells along a side of the cube, a power of two.
  double band_mm = 0.0;          ///< Samples up to this far from the surface are known.
  double tolerance_mm = 0.0;     ///< Every known sample is reproduced to this.
  bool closed = false;           ///< The surface encloses a volume: far sides are known.

  /// Every point up to this far from the surface lies between known samples.
  [[nodiscard]] double guaranteed_mm() const { return band_mm - std::numbers::sqrt3 * cell_mm; }
};

}  // namespace lefort::field
