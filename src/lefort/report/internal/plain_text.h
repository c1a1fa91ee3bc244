/// \file
/// Sanitizes text for drawing and for pages.
#pragma once

#include <string>
#include <string_view>

namespace lefort::report {

/// \returns valid UTF-8 without control characters: a byte that belongs to no character becomes
///   U+FFFD, a control character (also tab and line break) becomes a space. XML 1.0 allows the
///   result.
[[nodiscard]] std::string plain_text(std::string_view text);

/// \returns plain_text() with & < > " ' as entities, for element content and quoted attributes.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace lefort::report
