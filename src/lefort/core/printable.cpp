#include <lefort/core/printable.h>

namespace lefort {

std::string printable(std::string_view text, LineBreaks line_breaks) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto byte = static_cast<unsigned char>(text[at]);
    const bool is_kept = text[at] == '\t' || (text[at] == '\n' && line_breaks == LineBreaks::kKept);
    const auto next = at + 1 < text.size() ? static_cast<unsigned char>(text[at + 1]) : 0U;
    if (byte == 0xc2 && next >= 0x80 && next <= 0x9f) {
      shown += '?';
      ++at;
    } else {
      shown += !is_kept && (byte < 0x20 || byte == 0x7f) ? '?' : text[at];
    }
  }
  return shown;
}

}  // namespace lefort
