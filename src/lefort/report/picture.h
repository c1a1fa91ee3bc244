/// \file
/// A picture in memory, and its encoding as a PNG file.
#pragma once

#include <lefort/core/error.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lefort::report {

/// Rows from the top, pixels from the left, four bytes each: red, green, blue (sRGB), and 255
/// (opaque).
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

/// \param picture  any values.
/// \returns nothing; or kInvalidArgument if a side is not in [1, kMaxPictureSide], or the length of
///   `rgba` does not match.
[[nodiscard]] Result<void> check_picture(const Picture& picture);

/// \param picture  valid according to check_picture().
/// \returns the bytes of a PNG file, or the errors of check_picture().
[[nodiscard]] Result<std::string> encode_png(const Picture& picture);

}  // namespace lefort::report
