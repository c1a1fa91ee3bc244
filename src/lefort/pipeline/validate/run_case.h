/// \file
/// Predicts one case of a cohort and compares the prediction with the achieved face.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/predict.h>
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

/// How a case is predicted and compared, and where the files go.
struct CaseComputation {
  SetupOptions setup;
  std::filesystem::path work;      ///< Of the plan and of converted inputs.
  std::filesystem::path pictures;  ///< Folder of the pictures of the difference.
  std::string picture_prefix;      ///< Of the names of these pictures.
  bool has_pictures = true;        ///< Whether the difference is drawn.
  PredictJob predict;              ///< Output and options; plan and scan are those of the case.
};

struct ComputedCase {
  CaseResult result;
  nlohmann::json prediction;  ///< Summary of the prediction.
};

/// Predicts a case, and compares it with the face after surgery if the case has one.
///
/// \param result  with the name and the key of the case.
/// \returns the result, without regions if there is no face after surgery; or the errors of
///   set_up_case() and predict_case(); or kInvalidArgument if the faces have no common point.
[[nodiscard]] Result<ComputedCase> predict_and_compare(const CohortCase& one,
                                                       const CaseComputation& computation,
                                                       CaseResult result, Progress& progress);

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
