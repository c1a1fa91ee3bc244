/// \file
/// State shared by all routes: one case's folder, its jobs, and its caches.
#pragma once

#include <lefort/image/volume.h>
#include <lefort/io/step_skin.h>
#include <lefort/predict/face_preview.h>
#include <lefort/server/case/case_folder.h>
#include <lefort/server/case/event_log.h>
#include <lefort/server/case/jobs.h>
#include <lefort/server/case/lru_cache.h>
#include <lefort/server/case/overlap_service.h>
#include <lefort/server/case/solve_history.h>
#include <lefort/server/case/uploads.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace lefort::server {

/// Thread-safe.
struct ServedCase {
  /// \param example  scan of the bundled example.
  ServedCase(CaseFolder folder, std::optional<std::filesystem::path> example,
             UploadLimits upload_limits);
  ServedCase(const ServedCase&) = delete;
  ServedCase& operator=(const ServedCase&) = delete;

  CaseFolder folder;
  Uploads uploads;
  const std::optional<std::filesystem::path> example;
  EventLog events;
  SolveHistory solve_history;
  std::mutex writing;  ///< Held while a request changes the case or queues a job.
  LruCache<image::CtVolume> cached_volume;
  LruCache<OverlapService> cached_bones;
  LruCache<predict::FacePreview> cached_preview;
  LruCache<io::StepSkin> step_skins;
  LruCache<std::string> cached_surfaces;
  Jobs jobs;  ///< Last member: its worker uses the others.

  /// The scan.
  [[nodiscard]] Result<std::shared_ptr<const image::CtVolume>> volume();

  /// The model prepared by the job preview-factor; after a restart of the server it is made again
  /// from the cache.
  [[nodiscard]] Result<std::shared_ptr<const predict::FacePreview>> preview();

  /// Every stage by its name: contract/openapi.json, Stage.
  [[nodiscard]] nlohmann::json stages() const;

  /// Notifies pages that listen.
  void report_stages();
};

}  // namespace lefort::server
