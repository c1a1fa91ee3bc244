/// \file
/// Inverse planning: from a target face to bone movements.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

struct OptimizeJob {
  std::filesystem::path plan;               ///< Osteotomies, options, and the first movement.
  std::filesystem::path target;             ///< contract/target.schema.json.
  std::optional<std::filesystem::path> ct;  ///< Instead of the plan's.
  std::filesystem::path output;             ///< A folder; created if missing.
  int max_corrections = 8;                  ///< Solves of the model of the plan; 0: coarse only.
  bool pictures = true;
  bool check_gradient = true;
};

/// Finds the movements whose predicted face is closest to the target, within limits, and certifies
/// them by a full prediction in prediction/. Writes plan.json, report.html, pictures, and last
/// optimize.json.
///
/// \returns the summary, or
///   - kFileNotFound     plan, target, scan or a surface of the target does not exist;
///   - kPlanInvalid      the plan or the target violates its schema;
///   - kInvalidArgument  the target does not fit the patient, or the limits cannot be met;
///   - the errors of read_plan_of_scan(), prepare_case(), inverse::optimize_motion() and
///     predict_case();
///   - kFileUnwritable   a result cannot be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<Summary> optimize_plan(const OptimizeJob& job, Progress& progress);

}  // namespace lefort::pipeline
