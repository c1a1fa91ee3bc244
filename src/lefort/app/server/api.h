/// \file
/// What contract/openapi.json describes: requests about one case, answered from its folder. It
/// knows no socket; http_server.h brings the requests.
#pragma once

#include <lefort/app/server/case_folder.h>
#include <lefort/app/server/case_jobs.h>
#include <lefort/app/server/event_log.h>
#include <lefort/app/server/exchange.h>
#include <lefort/app/server/jobs.h>
#include <lefort/app/server/kept.h>
#include <lefort/app/server/live_bones.h>
#include <lefort/app/server/uploads.h>
#include <lefort/app/step_skin.h>
#include <lefort/image/volume.h>
#include <lefort/predict/face_preview.h>

#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::app::server {

inline constexpr std::string_view kApiPrefix = "/api/v1";

/// Values of a path's parameters, in their order.
using PathValues = std::vector<std::string>;

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
  [[nodiscard]] Reply handle(const Request& request);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.root(); }

  /// Events of pages that listen.
  [[nodiscard]] EventLog& events() { return events_; }

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
  struct Route;
  static std::span<const Route> table();

  Reply get_case(const Request&, const PathValues&);
  Reply post_upload(const Request&, const PathValues&);
  Reply put_upload_file(const Request&, const PathValues&);
  Reply delete_upload(const Request&, const PathValues&);
  Reply get_jobs(const Request&, const PathValues&);
  Reply post_job(const Request&, const PathValues&);
  Reply get_job(const Request&, const PathValues&);
  Reply delete_job(const Request&, const PathValues&);
  Reply get_events(const Request&, const PathValues&);
  Reply get_volume(const Request&, const PathValues&);
  Reply get_volume_data(const Request&, const PathValues&);
  Reply get_labels(const Request&, const PathValues&);
  Reply get_labels_data(const Request&, const PathValues&);
  Reply put_labels_data(const Request&, const PathValues&);
  Reply get_surfaces(const Request&, const PathValues&);
  Reply get_surface(const Request&, const PathValues&);
  Reply get_segment_surface(const Request&, const PathValues&);
  Reply get_landmarks(const Request&, const PathValues&);
  Reply put_landmarks(const Request&, const PathValues&);
  Reply post_measurements(const Request&, const PathValues&);
  Reply get_plan(const Request&, const PathValues&);
  Reply put_plan(const Request&, const PathValues&);
  Reply get_plan_poses(const Request&, const PathValues&);
  Reply post_osteotomy(const Request&, const PathValues&);
  Reply post_poses(const Request&, const PathValues&);
  Reply post_preview(const Request&, const PathValues&);
  Reply get_preview_distance(const Request&, const PathValues&);
  Reply get_prediction(const Request&, const PathValues&);
  Reply get_prediction_step(const Request&, const PathValues&);
  Reply get_files(const Request&, const PathValues&);
  Reply get_file(const Request&, const PathValues&);

  [[nodiscard]] nlohmann::json stages() const;
  void tell_stages();
  [[nodiscard]] Result<std::shared_ptr<const image::CtVolume>> volume();
  [[nodiscard]] Result<std::shared_ptr<const predict::FacePreview>> preview();
  /// Factorises, so that the first preview is as quick as the next.
  void warm_preview();
  Reply surface_reply(const Request&, const std::filesystem::path& file);

  CaseFolder folder_;
  Uploads uploads_;
  const std::optional<std::filesystem::path> example_;
  EventLog events_;
  std::mutex writing_;  ///< One page's change at a time.
  Kept<image::CtVolume> volume_;
  Kept<LiveBones> bones_;
  Kept<predict::FacePreview> preview_;
  Kept<StepSkin> steps_;
  Kept<std::string> surfaces_;
  Jobs jobs_;  ///< Last: its worker uses all above.
};

}  // namespace lefort::app::server
