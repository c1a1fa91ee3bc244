/// \file
/// Color maps.
#pragma once

#include <lefort/core/error.h>

#include <array>

namespace lefort::report {

/// Red, green, blue in sRGB, 0 to 1.
using Rgb = std::array<double, 3>;

enum class ColorMap {
  kSequential,  ///< From light (low) to dark (high) in even steps of lightness (magma).
  kDiverging,   ///< Blue below, light gray at, red above the middle (Moreland 2009).
};

/// Color of values that are NaN: not measured, or outside the field.
inline constexpr Rgb kMissingColor{0.62, 0.62, 0.62};

/// \param map       the color map.
/// \param fraction  0 is the low end of the map, 1 the high end; clamped to them.
/// \returns the color; kMissingColor if `fraction` is NaN.
[[nodiscard]] Rgb color_at(ColorMap map, double fraction);

/// A color map with the values at its ends.
struct ColorScale {
  ColorMap map = ColorMap::kSequential;
  double low = 0.0;
  double high = 1.0;  ///< > low.

  [[nodiscard]] Rgb color(double value) const {
    return color_at(map, (value - low) / (high - low));
  }
};

/// \param scale  any values.
/// \returns nothing, or kInvalidArgument unless both ends are finite and low < high.
[[nodiscard]] Result<void> check_scale(const ColorScale& scale);

}  // namespace lefort::report
