/// \file
/// Comma-separated values (RFC 4180, one record per line). Internal to io.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io::internal {

/// Returns the fields of a line without their quotes; nothing if a quoted field is not closed, or
/// text follows its closing quote.
[[nodiscard]] std::optional<std::vector<std::string>> split_csv(std::string_view line);

/// Returns a field for writing, quoted if necessary.
[[nodiscard]] std::string csv_field(std::string_view text);

}  // namespace lefort::io::internal
