/// \file
/// Units in lefort: length mm, force N, stress MPa = N/mm^2, energy mJ = N mm, angle rad, CT number
/// HU. Other units are converted at the input and output only, with these functions.
#pragma once

#include <numbers>

namespace lefort {

[[nodiscard]] constexpr double radians_from_degrees(double angle_deg) {
  return angle_deg * std::numbers::pi / 180.0;
}

[[nodiscard]] constexpr double degrees_from_radians(double angle_rad) {
  return angle_rad * 180.0 / std::numbers::pi;
}

[[nodiscard]] constexpr double mpa_from_kpa(double stress_kpa) { return stress_kpa * 1e-3; }

[[nodiscard]] constexpr double kpa_from_mpa(double stress_mpa) { return stress_mpa * 1e3; }

}  // namespace lefort
