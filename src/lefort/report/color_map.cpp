#include <lefort/report/color_map.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace lefort::report {

namespace {

// Each map at 33 equidistant points, sRGB; linear interpolation is within 2/255 of the original.
using Table = std::array<std::uint32_t, 33>;

// S. van der Walt, N. Smith: magma, in matplotlib 1.5 (CC0). The lighter 62 percent, light end
// first: darker colors would hide the shading, and with it the shape.
constexpr Table kLightToMagma{0xfcfdbf, 0xfcf4b6, 0xfdebad, 0xfde2a4, 0xfed99b, 0xfed093, 0xfec78b,
                              0xfebe83, 0xfeb57c, 0xfeab75, 0xfea26f, 0xfd9969, 0xfc9065, 0xfb8661,
                              0xfa7d5e, 0xf8745c, 0xf56b5c, 0xf2625d, 0xed5a5f, 0xe85362, 0xe24d66,
                              0xdb486a, 0xd4436e, 0xcc3f71, 0xc43c74, 0xbc3977, 0xb4367a, 0xac337c,
                              0xa4317e, 0x9c2e7f, 0x942c80, 0x8c2981, 0x842681};

// K. Moreland: Diverging color maps for scientific visualization, ISVC 2009; table of matplotlib
// ("coolwarm", public domain).
constexpr Table kCoolToWarm{0x3b4cc0, 0x445acc, 0x4d68d7, 0x5775e1, 0x6282ea, 0x6c8ef1, 0x779af7,
                            0x82a5fb, 0x8db0fe, 0x98b9ff, 0xa3c2fe, 0xaec9fc, 0xb8d0f9, 0xc2d5f4,
                            0xccd9ee, 0xd5dbe6, 0xdddddd, 0xe5d8d1, 0xecd3c5, 0xf1ccb9, 0xf4c4ad,
                            0xf7bba0, 0xf7b194, 0xf7a687, 0xf49a7b, 0xf18d6f, 0xec7f63, 0xe57058,
                            0xde604d, 0xd55042, 0xcb3e38, 0xc0282f, 0xb40426};

Rgb from_hex(std::uint32_t hex) {
  return {double(hex >> 16 & 0xff) / 255.0, double(hex >> 8 & 0xff) / 255.0,
          double(hex & 0xff) / 255.0};
}

}  // namespace

Rgb color_at(ColorMap map, double fraction) {
  if (std::isnan(fraction)) return kMissingColor;
  const Table& table = map == ColorMap::kSequential ? kLightToMagma : kCoolToWarm;
  const double place = std::clamp(fraction, 0.0, 1.0) * double(table.size() - 1);
  const std::size_t below = std::min(std::size_t(place), table.size() - 2);
  const double between = place - double(below);
  const Rgb from = from_hex(table[below]);
  const Rgb to = from_hex(table[below + 1]);
  Rgb color{};
  for (std::size_t c = 0; c < 3; ++c) color[c] = from[c] + between * (to[c] - from[c]);
  return color;
}

Result<void> check_scale(const ColorScale& scale) {
  if (std::isfinite(scale.low) && std::isfinite(scale.high) && scale.low < scale.high) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("color scale runs from {} to {}, must be finite and ascend", scale.low,
                          scale.high));
}

}  // namespace lefort::report
