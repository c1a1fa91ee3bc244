/// \file
/// From a plan to the predicted face.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>
#include <lefort/predict/face_prediction.h>

#include <filesystem>
#include <functional>
#include <optional>

namespace lefort::pipeline {

struct PredictJob {
  std::filesystem::path plan;
  std::optional<std::filesystem::path> ct;  ///< Instead of the plan's.
  std::filesystem::path output;             ///< A folder; made if missing.
  bool pictures = true;
  /// Told each step of the path as it is found; may be empty.
  std::function<void(const predict::PredictionStep&, int steps)> on_step{};
  /// Likewise each of Newton's iterations.
  std::function<void(const predict::PredictionIterate&, int steps)> on_iterate{};
};
/// Plan -> predicted face, with everything that documents it.
[[nodiscard]] Result<Summary> predict_case(const PredictJob& job, Progress& progress);

}  // namespace lefort::pipeline
