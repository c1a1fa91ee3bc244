/// \file
/// Trilinear interpolation in a cube.
#pragma once

#include <array>
#include <cstddef>

namespace lefort::field {

// Always inlined, so that Real may be a vector wider than the registers of the baseline.

/// Linear interpolation: `low` at fraction 0, `high` at fraction 1.
template <class Real>
[[nodiscard, gnu::always_inline]] inline Real lerp(const Real& fraction, const Real& low,
                                                   const Real& high) {
  return low + fraction * (high - low);
}

/// \param corners  values, x fastest.
/// \param t        position in the cube, 0 to 1 along each axis.
template <class Real>
[[nodiscard, gnu::always_inline]] inline Real trilinear(const std::array<Real, 8>& corners,
                                                        const std::array<Real, 3>& t) {
  const Real x0 = lerp(t[0], corners[0], corners[1]), x1 = lerp(t[0], corners[2], corners[3]),
             x2 = lerp(t[0], corners[4], corners[5]), x3 = lerp(t[0], corners[6], corners[7]);
  return lerp(t[2], lerp(t[1], x0, x1), lerp(t[1], x2, x3));
}

/// Derivative of trilinear() with respect to t.
template <class Real>
[[nodiscard, gnu::always_inline]] inline std::array<Real, 3> trilinear_gradient(
    const std::array<Real, 8>& corners, const std::array<Real, 3>& t) {
  const Real x0 = lerp(t[0], corners[0], corners[1]), x1 = lerp(t[0], corners[2], corners[3]),
             x2 = lerp(t[0], corners[4], corners[5]), x3 = lerp(t[0], corners[6], corners[7]);
  const Real slope_0 = corners[1] - corners[0], slope_1 = corners[3] - corners[2],
             slope_2 = corners[5] - corners[4], slope_3 = corners[7] - corners[6];
  return {lerp(t[2], lerp(t[1], slope_0, slope_1), lerp(t[1], slope_2, slope_3)),
          lerp(t[2], Real(x1 - x0), Real(x3 - x2)), lerp(t[1], x2, x3) - lerp(t[1], x0, x1)};
}

}  // namespace lefort::field
