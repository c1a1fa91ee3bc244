/// \file
/// On which side of an edge a line along x passes, so that the two triangles there agree.
#pragma once

#include <lefort/core/types.h>

#include <utility>

namespace lefort::field {

/// Twice the area of (a, b, p) in the plane of y and z, signed and never zero; the same number but
/// for the sign for (b, a, p). So a line along x through p crosses a closed surface as often one
/// way as the other, even where it grazes an edge.
[[nodiscard]] inline double turn_in_yz(const Vec3& a, const Vec3& b, const Vec3& p) {
  const bool swapped = std::pair(a.y(), a.z()) > std::pair(b.y(), b.z());
  const Vec3 &from = swapped ? b : a, &to = swapped ? a : b;
  const double area =
      (to.y() - from.y()) * (p.z() - from.z()) - (to.z() - from.z()) * (p.y() - from.y());
  const double sided = area == 0.0 ? 1e-300 : area;
  return swapped ? -sided : sided;
}

}  // namespace lefort::field
