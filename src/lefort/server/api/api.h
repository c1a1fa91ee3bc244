/// \file
/// What contract/openapi.json describes: requests about one case, answered from its folder. It
/// knows no socket; http_server.h brings the requests.
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

/// One case. Safe from many threads.
class Api {
 public:
  /// \param example  the scan that is imported on wish.
  Api(CaseFolder folder, std::optional<std::filesystem::path> example,
      UploadLimits upload_limits = {});
  ~Api();
  Api(const Api&) = delete;
  Api& operator=(const Api&) = delete;

  /// \pre request.path begins with kApiPrefix.
  [[nodiscard]] Response handle(const Request& request);

  [[nodiscard]] const std::filesystem::path& folder() const;

  /// Events of pages that listen.
  [[nodiscard]] EventLog& events();

  /// Imports and segments the example, unless there is a scan.
  ///
  /// \returns kFileNotFound if the example is not installed.
  [[nodiscard]] Result<void> begin_with_example();

  /// Ends what runs, and tells listeners.
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
