/// \file
/// Predicts one case of a cohort and compares the prediction with the achieved face.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/validate/case_result.h>
#include <lefort/pipeline/validate/set_up_case.h>

#include <filesystem>
#include <string>

namespace lefort::pipeline {

struct CaseJob {
  std::filesystem::path folder;  ///< Of the case.
  std::filesystem::path cohort;
  std::filesystem::path output;  ///< Of the cohort's report.
  SetupOptions setup;
  bool pictures = true;
};

/// Returns the stored result if inputs and options are unchanged. Otherwise predicts and compares,
/// and stores the result in `output`/cases/NAME/result.json. A case that fails has a result with
/// the reason, which is stored too unless the inputs cannot be read.
///
/// \returns the result; or kCancelled, kFileUnwritable or kOutOfMemory, which are not properties of
///   the case.
[[nodiscard]] Result<CaseResult> run_case(const CaseJob& job, Progress& progress);

enum class CaseNotes { kForward, kDrop };

/// Forwards the progress of a case with its name.
class CaseProgress : public Progress {
 public:
  /// \param prefix  of stages and notes.
  /// \param inner   outlives this object.
  /// \param notes   kDrop where the same stages run many times.
  CaseProgress(std::string prefix, Progress& inner, CaseNotes notes = CaseNotes::kForward)
      : prefix_(std::move(prefix)), inner_(inner), notes_(notes) {}
  void begin_stage(std::string_view name) override {
    inner_.begin_stage(prefix_ + std::string(name));
  }
  void report(double fraction) override { inner_.report(fraction); }
  void note(std::string_view sentence) override {
    if (notes_ == CaseNotes::kForward) inner_.note(prefix_ + std::string(sentence));
  }
  [[nodiscard]] bool stop_requested() const override { return inner_.stop_requested(); }

 private:
  std::string prefix_;
  Progress& inner_;
  CaseNotes notes_;
};

/// Whether an error is a property of the case. The others are properties of the run: kCancelled,
/// kFileUnwritable and kOutOfMemory.
[[nodiscard]] bool is_of_case(const Error& error);

}  // namespace lefort::pipeline
