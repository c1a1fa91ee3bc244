/// \file
/// Parsing and checking of numbers, bodies and preconditions of requests.
#pragma once

#include <lefort/server/api/message.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lefort::server {

inline constexpr std::uint64_t kMaxBody = 4 << 20;  ///< Bytes of JSON, as in the contract.

[[nodiscard]] Response empty_reply();
[[nodiscard]] Response not_modified(const std::optional<std::string>& etag);
[[nodiscard]] Response not_found(std::string_view what);
[[nodiscard]] Response with_etag(Response reply, const std::optional<std::string>& etag);

/// Whether the client has the present version (If-None-Match).
[[nodiscard]] bool is_not_modified(const Request& request, const std::optional<std::string>& etag);

/// Nothing if If-Match is the present entity tag or "*"; else the error response.
[[nodiscard]] std::optional<Response> check_precondition(const Request& request,
                                                         const std::optional<std::string>& etag);

/// An integer in decimal digits from `lowest` to `highest`; nothing for other text.
[[nodiscard]] std::optional<int> number_of(std::string_view text, int lowest, int highest);

/// An integer parameter of the query, or `otherwise` if it is missing; kInvalidArgument if it is
/// not an integer from `lowest` to `highest`.
[[nodiscard]] Result<int> query_number(const Request& request, const std::string& name,
                                       int otherwise, int lowest, int highest);

/// A body; if `text` is not set, `error` is the error response.
struct Body {
  std::optional<std::string> text;
  Response error;
};
[[nodiscard]] Body read_body(const Request& request, std::uint64_t max_bytes,
                             std::string_view type);

/// A body that matches a schema of the contract; if `value` is not set, `error` is the error
/// response.
struct JsonBody {
  std::optional<nlohmann::json> value;
  std::string text;
  Response error;
};
[[nodiscard]] JsonBody read_json(const Request& request, const std::string& schema);

}  // namespace lefort::server
