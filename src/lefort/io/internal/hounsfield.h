/// \file
/// Numbers of a file to CT numbers, and what had to be changed on the way.
#pragma once

#include <lefort/core/types.h>
#include <lefort/image/volume.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace lefort::io {

/// The range of a 12-bit CT. Scanners write less outside their field of view, more in metal.
inline constexpr double kLowestHu = -1024.0;
inline constexpr double kHighestHu = 3071.0;

/// How many values were not what a CT holds.
struct HounsfieldCount {
  Index beyond_range = 0;
  Index not_a_number = 0;
};

/// Rounds to whole HU within the range above; what is no number becomes air.
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

/// Warnings about what was changed in `ct`, about values that can hardly be HU, and about a field
/// of view that cuts the patient off within the grid.
[[nodiscard]] std::vector<std::string> hounsfield_warnings(const HounsfieldCount& count,
                                                           const image::CtVolume& ct);

}  // namespace lefort::io
