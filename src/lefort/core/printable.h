/// \file
/// Makes text from files and libraries safe to print to a terminal or a log.
#pragma once

#include <string>
#include <string_view>

namespace lefort {

enum class LineBreaks { kReplaced, kKept };

/// Replaces control characters by "?", because a terminal would execute them. Control characters
/// are the bytes below 0x20 except the tab, 0x7f, and U+0080 to U+009F in UTF-8.
///
/// \param text         in UTF-8 or any other text.
/// \param line_breaks  whether "\n" is replaced, too.
/// \returns the text.
[[nodiscard]] std::string printable(std::string_view text,
                                    LineBreaks line_breaks = LineBreaks::kReplaced);

}  // namespace lefort
