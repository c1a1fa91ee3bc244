/// \file
/// Lines of comma-separated values (RFC 4180, one line a record). For the .cpp files of this layer
/// alone.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io::internal {

/// The fields of a line, quotes taken off; nothing if a quote is not closed or text follows it.
[[nodiscard]] std::optional<std::vector<std::string>> split_csv(std::string_view line);

/// A field as it is written: in quotes if it needs them.
[[nodiscard]] std::string csv_field(std::string_view text);

}  // namespace lefort::io::internal
