/// \file
/// What all routes work on: one case's folder, its jobs, and what of it is in memory.
#pragma once

#include <lefort/app/server/case_folder.h>
#include <lefort/app/server/event_log.h>
#include <lefort/app/server/jobs.h>
#include <lefort/app/server/kept.h>
#include <lefort/app/server/live_bones.h>
#include <lefort/app/server/solve_history.h>
#include <lefort/app/server/uploads.h>
#include <lefort/app/step_skin.h>
#include <lefort/image/volume.h>
#include <lefort/predict/face_preview.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace lefort::app::server {

/// Safe from many threads.
struct ServedCase {
  /// \param example  the scan that is imported on wish.
  ServedCase(CaseFolder folder, std::optional<std::filesystem::path> example,
             UploadLimits upload_limits);
  ServedCase(const ServedCase&) = delete;
  ServedCase& operator=(const ServedCase&) = delete;

  CaseFolder folder;
  Uploads uploads;
  const std::optional<std::filesystem::path> example;
  EventLog events;
  SolveHistory solve_history;
  std::mutex writing;  ///< One page's change at a time.
  Kept<image::CtVolume> kept_volume;
  Kept<LiveBones> kept_bones;
  Kept<predict::FacePreview> kept_preview;
  Kept<StepSkin> kept_steps;
  Kept<std::string> kept_surfaces;
  Jobs jobs;  ///< Last: its worker uses all above.

  /// The scan.
  [[nodiscard]] Result<std::shared_ptr<const image::CtVolume>> volume();

  /// What preview-factor has prepared.
  [[nodiscard]] Result<std::shared_ptr<const predict::FacePreview>> preview();

  /// Every stage by its name: contract/openapi.json, Stage.
  [[nodiscard]] nlohmann::json stages() const;

  /// Tells pages that listen.
  void tell_stages();

 private:
  /// Factorises, so that the first preview is as quick as the next.
  void warm_preview();
};

}  // namespace lefort::app::server
