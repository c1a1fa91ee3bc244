/// \file
/// Interpolation between the eight corners of a cube.
#pragma once

#include <lefort/core/types.h>

#include <array>

namespace lefort::field {

/// \param corners  values, x fastest.
/// \param t        position in the cube, 0 to 1 along each axis.
[[nodiscard]] inline double trilinear(const std::array<double, 8>& corners, const Vec3& t) {
  const auto along_x = [&](std::size_t first) {
    return corners[first] + t.x() * (corners[first + 1] - corners[first]);
  };
  const double low = along_x(0) + t.y() * (along_x(2) - along_x(0));
  const double high = along_x(4) + t.y() * (along_x(6) - along_x(4));
  return low + t.z() * (high - low);
}

/// Derivative of trilinear() with respect to t.
[[nodiscard]] inline Vec3 trilinear_gradient(const std::array<double, 8>& corners, const Vec3& t) {
  Vec3 gradient = Vec3::Zero();
  for (std::size_t corner = 0; corner < 8; ++corner) {
    Vec3 weight, slope;
    for (int k = 0; k < 3; ++k) {
      const bool upper = (corner >> k & 1) != 0;
      weight[k] = upper ? t[k] : 1.0 - t[k];
      slope[k] = upper ? 1.0 : -1.0;
    }
    gradient += corners[corner] * Vec3(slope.x() * weight.y() * weight.z(),
                                       weight.x() * slope.y() * weight.z(),
                                       weight.x() * weight.y() * slope.z());
  }
  return gradient;
}

}  // namespace lefort::field
