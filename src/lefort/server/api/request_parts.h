/// \file
/// What routes ask of a request before they work: its numbers, its body, what it knows already.
#pragma once

#include <lefort/server/api/exchange.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lefort::server {

inline constexpr std::uint64_t kLargestBody = 4 << 20;  ///< Bytes of JSON, as the contract says.

[[nodiscard]] Reply empty_reply();
[[nodiscard]] Reply not_modified(const std::optional<std::string>& etag);
[[nodiscard]] Reply not_there(std::string_view what);
[[nodiscard]] Reply with_etag(Reply reply, const std::optional<std::string>& etag);

/// Whether the client has it already.
[[nodiscard]] bool is_known(const Request& request, const std::optional<std::string>& etag);

/// Nothing if the client knows what it replaces; else why it is refused.
[[nodiscard]] std::optional<Reply> check_precondition(const Request& request,
                                                      const std::optional<std::string>& etag);

/// A whole number in decimal digits within bounds.
[[nodiscard]] std::optional<int> number_of(std::string_view text, int lowest, int highest);

/// A query's whole number, or `otherwise` if it is not there.
[[nodiscard]] Result<int> query_number(const Request& request, const std::string& name,
                                       int otherwise, int lowest, int highest);

/// A body, or why it is refused.
struct Body {
  std::optional<std::string> text;
  Reply refused;
};
[[nodiscard]] Body read_body(const Request& request, std::uint64_t most_bytes,
                             std::string_view type);

/// A body that fits a schema of the contract, or why it is refused.
struct JsonBody {
  std::optional<nlohmann::json> value;
  std::string text;
  Reply refused;
};
[[nodiscard]] JsonBody read_json(const Request& request, const std::string& schema);

}  // namespace lefort::server
