/// \file
/// A picture in memory, and its bytes as a PNG file.
#pragma once

#include <lefort/core/error.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lefort::report {

/// Rows from the top, pixels from the left, four bytes each: red, green, blue (sRGB), and 255, as
/// pictures are opaque.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 * width * height bytes.

  [[nodiscard]] const std::uint8_t* pixel(int column, int row) const {
    return rgba.data() + 4 * (std::size_t(row) * std::size_t(width) + std::size_t(column));
  }
  bool operator==(const Picture&) const = default;
};

inline constexpr int kMaxPictureSide = 16384;

/// \returns kInvalidArgument when a side is not in [1, kMaxPictureSide], or `rgba` has another
///   length than the sides tell.
[[nodiscard]] Result<void> check_picture(const Picture& picture);

/// \returns the bytes of a PNG file, or what check_picture says.
[[nodiscard]] Result<std::string> encode_png(const Picture& picture);

}  // namespace lefort::report
