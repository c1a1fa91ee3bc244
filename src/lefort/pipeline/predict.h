/// \file
/// From a plan to the predicted face.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/cache/stage_cache.h>
#include <lefort/pipeline/summary.h>
#include <lefort/predict/face_prediction.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace lefort::pipeline {

struct PredictJob {
  std::filesystem::path plan;
  std::optional<std::filesystem::path> ct;  ///< Instead of the plan's.
  std::filesystem::path output;             ///< A folder; created if missing.
  bool pictures = true;
  /// Also solves with the interfaces `bonded` and `contact` on a coarse mesh
  /// (interface_sensitivity.h).
  bool sensitivity = true;
  bool paraview = true;  ///< Writes the tissue at each step.
  /// Run times and peak memory go to timing.json instead of prediction.json and the report, whose
  /// bytes then depend on the inputs alone.
  bool separate_timing = false;
  std::optional<SharedCache> shared_cache{};  ///< Instead of a cache in the output folder.
  /// Called after each converged step, also those of an interrupted run, with the number of steps
  /// of the path; may be empty.
  std::function<void(const predict::PredictionStep&, int steps)> on_step{};
  /// As `on_step`, after each Newton iteration.
  std::function<void(const predict::PredictionIterate&, int steps)> on_iterate{};
  /// Instead of the plan's segmentation.teeth: "auto", "none" or a tooth map.
  std::optional<std::string> teeth = std::nullopt;
};

/// Computes the predicted face of a plan; writes the report and the result files.
///
/// \returns the summary, or
///   - kFileNotFound    plan or scan does not exist;
///   - kPlanInvalid     the plan is invalid or names no scan, or a file that it names was changed
///     during the run;
///   - the errors of read_plan_of_scan(), prepare_case() and predict::predict_face();
///   - kNotConverged    the solver did not reach the end of the path: failure.json has its history;
///   - kFileUnwritable  a result cannot be written;
///   - kCancelled       `progress` requested a stop.
[[nodiscard]] Result<Summary> predict_case(const PredictJob& job, Progress& progress);

}  // namespace lefort::pipeline
