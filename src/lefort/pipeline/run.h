/// \file
/// Predictions of all cases of a cohort with all parameter sets, by any number of processes.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// Arguments of a BIDS App \cite gorgolewski2017 , see docs/guide/cohorts.md. An evaluation is the
/// prediction of one case with one parameter set.
struct RunJob {
  std::filesystem::path input;              ///< A BIDS dataset, or a cohort as for ValidateJob.
  std::filesystem::path output;             ///< A folder; created if missing.
  std::vector<std::string> participants{};  ///< Labels; empty: all cases.
  std::optional<std::filesystem::path> parameters{};  ///< File of parameter sets; none: one set.
  std::vector<std::string> sets{};                    ///< Names; empty: all sets of the file.
  /// For unfinished predictions and the cache; default: OUTPUT/.lefort. Processes of one run share
  /// it.
  std::optional<std::filesystem::path> work{};
  bool skip_bids_validation = false;
  bool achieved_movements = false;  ///< As for ValidateJob.
  double voxel_mm = 1.0;            ///< As for ValidateJob.
  bool pictures = true;
  bool paraview = false;              ///< Writes the tissue at each step.
  std::optional<double> memory_gb{};  ///< Limit of the data of this process, 1e9 bytes; > 0.
};

/// Computes each evaluation that is not finished. Processes may run at the same time: each
/// evaluation is computed by one. An evaluation that fails does not stop the others.
///
/// \returns the summary; or the first error of an evaluation, after all were tried; or
///   - kFileNotFound, kFileCorrupt, kPlanInvalid, kInvalidArgument   input, labels, or sets;
///   - kOutOfMemory     the machine has less memory than `memory_gb`;
///   - kFileUnwritable  a result could not be written: the rest is not tried;
///   - kCancelled       `progress` requested a stop.
[[nodiscard]] Result<Summary> run_participants(const RunJob& job, Progress& progress);

/// Lists the evaluations with their states, and computes nothing. `files` in the JSON are the input
/// files of a case, relative to the input folder.
///
/// \returns as run_participants().
[[nodiscard]] Result<Summary> list_evaluations(const RunJob& job);

/// Writes group.json, group.csv, regions.csv, report.html and figures/ from the finished
/// evaluations. Those that failed or are missing are listed with their reason.
///
/// \returns the summary; or as run_participants().
[[nodiscard]] Result<Summary> run_group(const RunJob& job, Progress& progress);

/// \returns a label that occurs twice, with or without "sub-"; nothing if there is none.
[[nodiscard]] std::optional<std::string> repeated_label(const std::vector<std::string>& labels);

}  // namespace lefort::pipeline
