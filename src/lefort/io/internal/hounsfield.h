/// \file
/// Conversion of stored numbers to CT numbers, and a count of the changed values.
#pragma once

#include <lefort/core/types.h>
#include <lefort/image/volume.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace lefort::io {

/// Range of a 12-bit CT. Scanners write smaller values outside their field of view and larger ones
/// in metal.
inline constexpr double kLowestHu = -1024.0;
inline constexpr double kHighestHu = 3071.0;

/// Number of values that a CT cannot contain.
struct HounsfieldCount {
  Index beyond_range = 0;
  Index not_a_number = 0;
};

/// Rounds to whole HU and clamps to the range above; NaN becomes air.
[[nodiscard]] inline std::int16_t hounsfield(double value, HounsfieldCount& count) {
  if (value >= kLowestHu && value <= kHighestHu)
    return static_cast<std::int16_t>(std::lround(value));
  if (std::isnan(value)) {
    ++count.not_a_number;
    return static_cast<std::int16_t>(kLowestHu);
  }
  ++count.beyond_range;
  return static_cast<std::int16_t>(value < 0.0 ? kLowestHu : kHighestHu);
}

/// Returns warnings about changed values, about values that are probably not in HU, and about
/// tissue that is cut off inside the grid, where the field of view ends and padding begins.
[[nodiscard]] std::vector<std::string> hounsfield_warnings(const HounsfieldCount& count,
                                                           const image::CtVolume& ct);

}  // namespace lefort::io
