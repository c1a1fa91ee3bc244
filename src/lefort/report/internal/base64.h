/// \file
/// Base64 encoding for data URLs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lefort::report {

/// \returns the bytes encoded according to RFC 4648, section 4, with padding.
[[nodiscard]] inline std::string base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::string_view group = bytes.substr(i, 3);
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < 3; ++b)
      bits = bits << 8U | (b < group.size() ? std::uint8_t(group[b]) : 0U);
    for (std::size_t c = 0; c < 4; ++c)
      text += c <= group.size() ? kAlphabet[bits >> (18U - 6U * c) & 0x3fU] : '=';
  }
  return text;
}

}  // namespace lefort::report
