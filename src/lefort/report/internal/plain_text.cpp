#include <lefort/core/escape_markup.h>
#include <lefort/report/internal/plain_text.h>

#include <cstddef>
#include <cstdint>

namespace lefort::report {

namespace {

constexpr std::string_view kReplacement = "\uFFFD";

bool is_continuation(char byte) { return (std::uint8_t(byte) & 0xc0U) == 0x80U; }

/// \returns the length of a character with this first byte; 0 if there is none.
std::size_t length_from(std::uint8_t lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xc2 && lead < 0xe0) return 2;
  if (lead >= 0xe0 && lead < 0xf0) return 3;
  if (lead >= 0xf0 && lead < 0xf5) return 4;
  return 0;
}

/// The code point at the start of `text`, and its length in bytes: 0 if it is malformed.
struct Decoded {
  char32_t code;
  std::size_t length;
};
Decoded decode(std::string_view text) {
  const auto lead = std::uint8_t(text.front());
  const std::size_t length = length_from(lead);
  if (length == 0 || length > text.size()) return {0, 0};
  if (length == 1) return {lead, 1};
  char32_t code = lead & (0xffU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if (!is_continuation(text[i])) return {0, 0};
    code = code << 6U | (std::uint8_t(text[i]) & 0x3fU);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (overlong || surrogate || code > 0x10ffff) return {0, 0};
  return {code, length};
}

bool is_control(char32_t code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

/// U+FFFE and U+FFFF, which XML does not allow.
bool is_no_character(char32_t code) { return code == 0xfffe || code == 0xffff; }

}  // namespace

std::string plain_text(std::string_view text) {
  std::string plain;
  plain.reserve(text.size());
  while (!text.empty()) {
    const Decoded next = decode(text);
    if (next.length == 0 || is_no_character(next.code))
      plain += kReplacement;
    else if (is_control(next.code))
      plain += ' ';
    else
      plain += text.substr(0, next.length);
    text.remove_prefix(next.length == 0 ? 1 : next.length);
  }
  return plain;
}

std::string escaped(std::string_view text) { return escape_markup(plain_text(text)); }

}  // namespace lefort::report
