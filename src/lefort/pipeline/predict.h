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
  std::filesystem::path output;             ///< A folder; created if missing.
  bool pictures = true;
  /// Also solves with the interfaces `bonded` and `contact` on a coarse mesh
  /// (interface_sensitivity.h).
  bool sensitivity = true;
  /// Called after each converged step; may be empty.
  std::function<void(const predict::PredictionStep&, int steps)> on_step{};
  /// Called after each Newton iteration; may be empty.
  std::function<void(const predict::PredictionIterate&, int steps)> on_iterate{};
};

/// Computes the predicted face of a plan; writes the report and the result files.
///
/// \returns the summary; kPlanInvalid or what reading, prepare_case() and predict_face() return; or
///   the failure of a path that did not converge.
[[nodiscard]] Result<Summary> predict_case(const PredictJob& job, Progress& progress);

}  // namespace lefort::pipeline
