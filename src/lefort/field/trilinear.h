/// \file
/// Interpolation between the eight corners of a cube.
#pragma once

#include <array>
#include <cstddef>

namespace lefort::field {

/// \param corners  values, x fastest.
/// \param t        position in the cube, 0 to 1 along each axis.
template <class Real>
[[nodiscard]] Real trilinear(const std::array<Real, 8>& corners, const std::array<Real, 3>& t) {
  const auto along_x = [&](std::size_t first) {
    return corners[first] + t[0] * (corners[first + 1] - corners[first]);
  };
  const Real low = along_x(0) + t[1] * (along_x(2) - along_x(0));
  const Real high = along_x(4) + t[1] * (along_x(6) - along_x(4));
  return low + t[2] * (high - low);
}

/// Derivative of trilinear() with respect to t.
template <class Real>
[[nodiscard]] std::array<Real, 3> trilinear_gradient(const std::array<Real, 8>& corners,
                                                     const std::array<Real, 3>& t) {
  const auto mix = [](Real share, Real low, Real high) { return low + share * (high - low); };
  const auto slope_x = [&](std::size_t first) { return corners[first + 1] - corners[first]; };
  const auto at_x = [&](std::size_t first) {
    return mix(t[0], corners[first], corners[first + 1]);
  };
  const std::array<Real, 4> edge = {at_x(0), at_x(2), at_x(4), at_x(6)};
  return {mix(t[2], mix(t[1], slope_x(0), slope_x(2)), mix(t[1], slope_x(4), slope_x(6))),
          mix(t[2], edge[1] - edge[0], edge[3] - edge[2]),
          mix(t[1], edge[2], edge[3]) - mix(t[1], edge[0], edge[1])};
}

}  // namespace lefort::field
