/// \file
/// Recognizes points beyond the border of an open surface.
#pragma once

#include <lefort/core/types.h>

#include <algorithm>

namespace lefort::dental {

/// The closest point of an open surface may lie on its border; the point then is neither inside nor
/// outside.
///
/// \param offset  from the closest point of the surface to the point [mm].
/// \param normal  unit normal of the surface there.
/// \returns whether the point is further from the line along the normal than 0.3 mm and than half
///   its distance.
[[nodiscard]] inline bool is_beyond_border(const Vec3& offset, const Vec3& normal) {
  constexpr double kLateral_mm = 0.3, kLateralRatio = 0.5;
  return (offset - normal.dot(offset) * normal).norm() >
         std::max(kLateral_mm, kLateralRatio * offset.norm());
}

}  // namespace lefort::dental
