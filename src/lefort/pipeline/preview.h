/// \file
/// The preview of a plan's face.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>
#include <lefort/predict/face_preview.h>

#include <filesystem>

namespace lefort::pipeline {

struct PreviewJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path cache;   ///< Folder of cached stages.
  std::filesystem::path skin;    ///< skin.vtp of segment_scan(); the preview displaces it.
  std::filesystem::path output;  ///< A folder; made if missing.
};

struct PreparedPreview {
  Summary summary;
  predict::FacePreview face;
};

/// Makes the live model of the face for any motion of the segments, and writes the interface map
/// and, last, preview.json.
///
/// \returns the model, or
///   - the errors of io::read_plan_text(), io::read_surface(), prepare_case() and
///     predict::FacePreview::create();
///   - kPlanInvalid     the skin was made with other thresholds or labels than the plan's;
///   - kFileUnwritable  a result cannot be written.
[[nodiscard]] Result<PreparedPreview> prepare_preview(const PreviewJob& job, Progress& progress);

/// The same model again, from the cache; writes nothing.
[[nodiscard]] Result<predict::FacePreview> load_preview(const PreviewJob& job, Progress& progress);

}  // namespace lefort::pipeline
