/// \file
/// Uncertainty of a predicted face by that of its inputs.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace lefort::pipeline {

/// A part of the samples, for one of several processes: numbers from 1.
struct SampleChunk {
  int number = 1, count = 1;
};

struct UncertaintyJob {
  std::filesystem::path plan;
  std::optional<std::filesystem::path> ct{};  ///< Instead of the plan's.
  std::filesystem::path output;               ///< A folder; created if missing.
  /// Inputs with distributions (contract/uncertain_inputs.schema.json); none: the default ones.
  std::optional<std::filesystem::path> inputs{};
  int samples = 200;       ///< Of the coarse model, 20 to 20000.
  int fine_samples = 6;    ///< Of the plan's own mesh; 0, or 3 or more.
  std::uint64_t seed = 1;  ///< Of the design, of the draws of the surrogate, of the bootstrap.
  /// Samples that are also solved from rest along the whole path: the check of the warm start.
  int path_checks = 3;
  bool pictures = true;
  /// Solves these samples only and writes no results; a run without a chunk then finds them.
  std::optional<SampleChunk> chunk{};
};

/// Samples the inputs, solves the samples, fits the surrogate, and writes uncertainty.json,
/// samples.csv, uncertainty.vtp, inputs.json, report.html and pictures/. Finished samples are
/// stored in samples/ and found again; results have the same bytes for any number of threads, of
/// chunks and of interruptions.
///
/// \returns the summary; or
///   - the errors of read_inputs(), inputs_of_plan(), read_plan_of_scan() and prepare_case();
///   - kInvalidArgument  an option is out of range;
///   - kNotConverged     the nominal equilibrium was not found, or too few samples have one;
///   - kFileUnwritable   a result cannot be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<Summary> quantify_uncertainty(const UncertaintyJob& job, Progress& progress);

/// The default inputs of a plan, in the format of UncertaintyJob::inputs.
///
/// \returns the text, or the errors of io::read_open_plan() and io::read_plan().
[[nodiscard]] Result<Summary> default_uncertain_inputs(const std::filesystem::path& plan);

}  // namespace lefort::pipeline
