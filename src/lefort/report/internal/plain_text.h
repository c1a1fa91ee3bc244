/// \file
/// Text from anywhere made safe to be drawn or put into a page.
#pragma once

#include <string>
#include <string_view>

namespace lefort::report {

/// Valid UTF-8 without control characters: a byte that belongs to no character becomes U+FFFD, a
/// control character (also tab and line break) becomes a space. XML 1.0 admits the result.
[[nodiscard]] std::string plain_text(std::string_view text);

/// plain_text with & < > " ' as entities: for element content and quoted attributes alike.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace lefort::report
