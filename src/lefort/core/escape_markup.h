/// \file
/// Escapes text for XML and HTML. It is in core because both io and report use it.
#pragma once

#include <string>
#include <string_view>

namespace lefort {

/// Replaces & < > " ' by character references, for element content and quoted attributes.
///
/// \param text  UTF-8. Bytes that XML does not allow (control characters, invalid UTF-8) are
///   copied.
/// \returns the escaped text.
[[nodiscard]] std::string escape_markup(std::string_view text);

}  // namespace lefort
