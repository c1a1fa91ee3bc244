/// \file
/// Conversion of pictures to and from cairo's CAIRO_FORMAT_RGB24 (words 0x00RRGGBB, rows without
/// padding).
#pragma once

#include <lefort/report/picture.h>

#include <cstdint>
#include <vector>

namespace lefort::report {

/// \pre check_picture(picture)
[[nodiscard]] inline std::vector<std::uint32_t> cairo_pixels(const Picture& picture) {
  std::vector<std::uint32_t> words(picture.rgba.size() / 4);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::uint8_t* rgba = picture.rgba.data() + 4 * i;
    words[i] = std::uint32_t(rgba[0]) << 16 | std::uint32_t(rgba[1]) << 8 | rgba[2];
  }
  return words;
}

/// \pre width * height words
[[nodiscard]] inline Picture picture_from(const std::vector<std::uint32_t>& words, int width,
                                          int height) {
  Picture picture{width, height, std::vector<std::uint8_t>(4 * words.size())};
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::uint8_t* rgba = picture.rgba.data() + 4 * i;
    rgba[0] = std::uint8_t(words[i] >> 16);
    rgba[1] = std::uint8_t(words[i] >> 8);
    rgba[2] = std::uint8_t(words[i]);
    rgba[3] = 255;
  }
  return picture;
}

}  // namespace lefort::report
