/// \file
/// Statistics of the displacement of the skin.
#pragma once

#include <lefort/core/types.h>

#include <span>

namespace lefort::predict {

struct SkinDisplacementStatistics {
  double max_mm = 0.0;              ///< 0 without vertices.
  double mean_over_moved_mm = 0.0;  ///< Over vertices displaced by more than 0.5 mm; 0 if none.
};

/// \param displacement_mm  of every vertex of the skin.
[[nodiscard]] SkinDisplacementStatistics measure_skin_displacement(
    std::span<const Vec3> displacement_mm);

}  // namespace lefort::predict
