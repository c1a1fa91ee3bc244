/// \file
/// The planner's server.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <string>

namespace lefort::server {

struct ServeJob {
  std::filesystem::path folder = "lefort-case";  ///< Of the case; made if missing.
  std::string host = "127.0.0.1";                ///< The address to listen at.
  int port = 8765;                               ///< 0: any free port.
  bool open = false;                             ///< Opens the page in the default browser.
  bool demo = false;  ///< Starts with the example, unless the case has a scan.
  /// Scan of the example, a file of Debian's invesalius-examples.
  std::filesystem::path example = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
};

/// Serves until `progress` requests a stop. Once the page can be opened, its address, which
/// contains the secret token, is printed on stdout.
///
/// \returns a summary; the errors of CaseFolder::open() and HttpServer::bind(); kFileNotFound with
///   `demo` if there is no example; or kInvalidArgument if listening ended without a request.
[[nodiscard]] Result<pipeline::Summary> serve_case(const ServeJob& job, Progress& progress);

}  // namespace lefort::server
