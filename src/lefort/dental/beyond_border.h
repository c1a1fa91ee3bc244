/// \file
/// Recognizes points beyond the border of an open surface.
#pragma once

#include <lefort/core/types.h>

#include <algorithm>

namespace lefort::dental {

/// The closest point of an open surface may lie on its border; the point then is neither inside nor
/// outside.
///
/// \param apart   from the closest point of the surface to the point [mm].
/// \param normal  unit normal of the surface there.
/// \returns whether the point is further beside the normal than 0.3 mm and than half its distance.
[[nodiscard]] inline bool is_beyond_border(const Vec3& apart, const Vec3& normal) {
  constexpr double kBeside_mm = 0.3, kBesideRatio = 0.5;
  return (apart - normal.dot(apart) * normal).norm() >
         std::max(kBeside_mm, kBesideRatio * apart.norm());
}

}  // namespace lefort::dental
