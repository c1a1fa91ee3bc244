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
  std::filesystem::path folder = "lefort-case";
  std::string host = "127.0.0.1";
  int port = 8765;
  bool open = false;
  bool demo = false;  ///< Starts with the example, unless the case has a scan.
  /// File of Debian's invesalius-examples.
  std::filesystem::path example = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
};

/// Serves until `progress` requests to stop. Prints the page's address on stdout once it can be
/// opened.
[[nodiscard]] Result<pipeline::Summary> serve_case(const ServeJob& job, Progress& progress);

}  // namespace lefort::server
