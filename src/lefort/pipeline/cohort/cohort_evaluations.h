/// \file
/// The cases and parameter sets of a run.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/parameter_sets.h>
#include <lefort/pipeline/cohort/evaluation.h>
#include <lefort/pipeline/run.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct Participant {
  std::string label;  ///< Letters and digits of the folder's name, without "sub-".
  std::filesystem::path folder;
};

struct CohortRun {
  std::vector<Participant> participants;  ///< In the order of their folders.
  std::vector<io::ParameterSet> sets;     ///< In the order of their file.
};

/// Reads cases and parameter sets, and checks the folders. Writes nothing.
///
/// \returns those that the job names; kFileNotFound, kFileCorrupt or kPlanInvalid of the input or
///   of the parameter sets; or kInvalidArgument for an unknown label or set, for two folders with
///   one label, a dataset without its description, or an output in place of the input.
[[nodiscard]] Result<CohortRun> open_run(const RunJob& job);

enum class EvaluationState { kPredicted, kFailed, kOutdated, kMissing };

[[nodiscard]] const char* name_of(EvaluationState state);

/// An evaluation as found in the output folder.
struct FoundEvaluation {
  EvaluationState state = EvaluationState::kMissing;
  std::string reason{};   ///< Unless predicted.
  Evaluation evaluation;  ///< If predicted or failed.
};

/// Looks for a finished evaluation with these options. The files of the case are not read: whether
/// they have changed is checked by run_participants().
[[nodiscard]] FoundEvaluation find_evaluation(const RunJob& job, const Participant& participant,
                                              const io::ParameterSet& set);

}  // namespace lefort::pipeline
