/// \file
/// The API of contract/openapi.json: answers requests about one case from its folder, independent
/// of the transport (server/http/http_server.h).
#pragma once

#include <lefort/server/api/message.h>
#include <lefort/server/case/case_folder.h>
#include <lefort/server/case/event_log.h>
#include <lefort/server/case/uploads.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace lefort::server {

inline constexpr std::string_view kApiPrefix = "/api/v1";

struct ServedCase;

/// The API of one case. Thread-safe.
class Api {
 public:
  /// \param example  scan of the bundled example.
  Api(CaseFolder folder, std::optional<std::filesystem::path> example,
      UploadLimits upload_limits = {});
  ~Api();
  Api(const Api&) = delete;
  Api& operator=(const Api&) = delete;

  /// \pre request.path begins with kApiPrefix.
  [[nodiscard]] Response handle(const Request& request);

  [[nodiscard]] const std::filesystem::path& folder() const;

  /// The event log.
  [[nodiscard]] EventLog& events();

  /// Imports and segments the example, unless the case has a scan.
  ///
  /// \returns kFileNotFound if the example is not installed.
  [[nodiscard]] Result<void> begin_with_example();

  /// Stops the running job and notifies listeners.
  void stop();

  /// A method and a path as in the contract: "GET", "/jobs/{job}".
  struct RouteName {
    std::string_view method, path;
  };
  [[nodiscard]] static std::vector<RouteName> routes();

 private:
  std::unique_ptr<ServedCase> served_;
};

}  // namespace lefort::server
