/// \file
/// Numbers as colors.
#pragma once

#include <lefort/core/error.h>

#include <array>

namespace lefort::report {

/// Red, green, blue in sRGB, 0 to 1.
using Rgb = std::array<double, 3>;

enum class ColorMap {
  kSequential,  ///< From nothing, light, to much, dark, in even steps of lightness (magma).
  kDiverging,   ///< Below, at and above a middle, blue to white to red (Moreland's cool to warm).
};

/// What a value looks like that is not a number: not measured, outside the field.
inline constexpr Rgb kMissingColor{0.62, 0.62, 0.62};

/// \param share 0 is the low end of the map, 1 the high end; clamped to them.
/// \returns kMissingColor when `share` is NaN.
[[nodiscard]] Rgb color_at(ColorMap map, double fraction);

/// A map with the values at its ends.
struct ColorScale {
  ColorMap map = ColorMap::kSequential;
  double low = 0.0;
  double high = 1.0;  ///< > low.

  [[nodiscard]] Rgb color(double value) const {
    return color_at(map, (value - low) / (high - low));
  }
};

/// \returns kInvalidArgument unless both ends are finite and low < high.
[[nodiscard]] Result<void> check_scale(const ColorScale& scale);

}  // namespace lefort::report
