/// \file
/// Text made safe to stand in XML or HTML.
#pragma once

#include <string>
#include <string_view>

namespace lefort {

/// `text` with & < > " ' as character references: for element content and quoted attributes alike.
/// Bytes that XML does not admit (control characters, broken UTF-8) are not looked at.
[[nodiscard]] std::string escape_markup(std::string_view text);

}  // namespace lefort
