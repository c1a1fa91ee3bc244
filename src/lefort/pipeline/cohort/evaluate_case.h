/// \file
/// Computes one evaluation, exactly once among all processes.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/cohort/cohort_evaluations.h>
#include <lefort/pipeline/cohort/evaluation.h>
#include <lefort/pipeline/validate/find_cases.h>

#include <optional>
#include <string>

namespace lefort::pipeline {

/// The files of a case and their hash, read once for all parameter sets.
class CaseInputs {
 public:
  explicit CaseInputs(Participant participant) : participant_(std::move(participant)) {}

  [[nodiscard]] const Participant& participant() const { return participant_; }
  /// \returns the files, or the errors of find_case() and fingerprint_case().
  [[nodiscard]] const Result<CohortCase>& files();
  /// \returns the hash; empty if the files cannot be read.
  [[nodiscard]] const std::string& sha256();

 private:
  void read();

  Participant participant_;
  std::optional<Result<CohortCase>> files_{};
  std::string sha256_{};
};

struct Evaluated {
  Evaluation evaluation;
  bool is_reused = false;  ///< Finished by an earlier attempt or by another process.
};

/// Returns the finished evaluation of the same inputs and options, or computes it. The results are
/// written to a folder beside their place, which then gets its name: they are complete or absent.
/// Leftovers of attempts that were killed are removed. A case that fails has an evaluation with the
/// reason, which is also stored.
///
/// \returns the evaluation; nothing if another process computes it; or kCancelled, kFileUnwritable
///   or kOutOfMemory, which are not properties of the case.
[[nodiscard]] Result<std::optional<Evaluated>> try_evaluate(const RunJob& job, CaseInputs& inputs,
                                                            const io::ParameterSet& set,
                                                            Progress& progress);

}  // namespace lefort::pipeline
