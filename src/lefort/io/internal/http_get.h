/// \file
/// One HTTP request after another, received piece by piece. The one place that knows libcurl.
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
  std::string user, password;  ///< Both empty: nobody.
};

struct HttpRequest {
  std::string path;    ///< With the query.
  std::string accept;  ///< Media types.
  std::chrono::seconds idle_timeout{30};
  std::chrono::seconds total_timeout{3600};
  std::uint64_t header_bytes = 1 << 18;  ///< Most of all headers, those of status 100 counted.
  std::function<Result<void>(const std::string& content_type)> begin{};  ///< Of an answer with 200.
  std::function<Result<void>(std::string_view bytes)> receive{};
};

/// Asks and listens until the answer has ended. Redirections are not followed: a password would go
/// with them.
///
/// \returns what `begin` or `receive` returned, or
///   - kFileNotFound     no server answers, or it answers 204 or 404;
///   - kFileUnsupported  it refuses user or password, or answers with another status;
///   - kFileCorrupt      the connection was lost, took longer or sent more headers than allowed;
///   - kCancelled        `progress` asked to stop.
[[nodiscard]] Result<void> http_get(const HttpServer& server, const HttpRequest& request,
                                    Progress& progress);

}  // namespace lefort::io
