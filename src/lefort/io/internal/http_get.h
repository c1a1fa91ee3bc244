/// \file
/// HTTP requests whose responses are received in pieces. No other file of io uses libcurl.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace lefort::io {

struct HttpServer {
  bool is_encrypted = false;
  std::string host;
  int port = 80;
  std::string user, password;  ///< No authentication if both are empty.
};

struct HttpRequest {
  std::string path;                          ///< With its query.
  std::string accept;                        ///< Accepted media types.
  std::chrono::seconds idle_timeout{30};     ///< To connect, and without data.
  std::chrono::seconds total_timeout{3600};  ///< Of the whole request.
  std::uint64_t header_bytes = 1 << 18;  ///< Limit of all headers, including those of status 100.
  /// Called once, before the body of a response with status 200.
  std::function<Result<void>(const std::string& content_type)> begin{};
  std::function<Result<void>(std::string_view bytes)> receive{};  ///< For each piece of the body.
};

/// Sends a GET request and receives its response. Redirections are not followed, since the password
/// would be sent to the new address.
///
/// \param server    host, port and credentials.
/// \param request   path, limits and the functions that receive the response.
/// \param progress  may stop the transfer.
/// \returns nothing, the error of `begin` or `receive`, or
///   - kConnectionFailed  no server answers, its certificate is not trusted, the connection was
///                        lost or timed out, or libcurl lacks a required option;
///   - kAccessDenied      the server rejects the user name or password (401, 403);
///   - kFileNotFound      status 204 or 404;
///   - kFileUnsupported   another status than 200;
///   - kFileCorrupt       more than header_bytes of headers;
///   - kCancelled         `progress` requested a stop.
[[nodiscard]] Result<void> http_get(const HttpServer& server, const HttpRequest& request,
                                    Progress& progress);

}  // namespace lefort::io
