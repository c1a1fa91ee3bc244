/// \file
/// Request and response, independent of the transport.
#pragma once

#include <lefort/core/error.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lefort::server {

/// Receives a piece of a body. \returns false to stop.
using BodyTaker = std::function<bool(std::string_view piece)>;

struct Request {
  std::string method;                         ///< "GET", "PUT", "POST", "DELETE".
  std::string path;                           ///< Decoded, without query: "/api/v1/case".
  std::map<std::string, std::string> query;   ///< Decoded; the first of equal names.
  std::map<std::string, std::string> header;  ///< Names in lower case.
  std::uint64_t content_length = 0;
  /// Passes the body on in pieces; false if it is incomplete. May be called once.
  std::function<bool(const BodyTaker&)> read_body;

  /// The value of a header, or an empty text.
  [[nodiscard]] const std::string& header_or_empty(const std::string& lower_case_name) const;
};

/// Bytes with shared ownership.
struct SharedBytes {
  std::shared_ptr<const void> owner;
  std::string_view bytes;
};

[[nodiscard]] SharedBytes shared_bytes(std::string text);

struct Response {
  int status = 200;
  std::string type = "application/json";
  std::vector<std::pair<std::string, std::string>> headers{};
  std::string text{};  ///< The body, unless `bytes`, `file` or `events_after` is set.
  std::optional<SharedBytes> bytes = std::nullopt;           ///< A large body.
  std::optional<std::filesystem::path> file = std::nullopt;  ///< A body that is a file.
  /// Event stream, from the event after this id.
  std::optional<std::string> events_after = std::nullopt;
};

[[nodiscard]] Response json_response(const nlohmann::json& json, int status = 200);
[[nodiscard]] Response binary_response(SharedBytes bytes);

/// Error response (contract/openapi.json, Error).
///
/// \param message  one line; line breaks are replaced by spaces.
/// \param where    parameter, header or key in error; may be empty.
[[nodiscard]] Response error_response(int status, std::string_view code, std::string_view message,
                                      std::string_view where = "");

/// Error response for an error of the library.
[[nodiscard]] Response error_response(const Error& error, std::string_view where = "");

}  // namespace lefort::server
