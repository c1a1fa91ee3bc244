/// \file
/// The error of a case as a function of the parameters of its prediction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/validate/calibration_parameters.h>
#include <lefort/pipeline/validate/fit_parameters.h>
#include <lefort/pipeline/validate/set_up_case.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// A case whose prediction is computed with any values of the parameters. Each result is stored, so
/// that a run which was stopped need not compute it again.
class CalibrationCase {
 public:
  /// \param one         the case.
  /// \param work        folder for the files of this case.
  /// \param setup       see SetupOptions.
  /// \param parameters  that are fitted.
  /// \returns the case, or the errors of fingerprint_case().
  [[nodiscard]] static Result<CalibrationCase> open(const CohortCase& one,
                                                    const std::filesystem::path& work,
                                                    const SetupOptions& setup,
                                                    std::vector<CalibrationParameter> parameters);

  /// Predicts the face and compares it with the achieved face, in all regions of the face.
  ///
  /// \param values    of the parameters.
  /// \param progress  of the stages; may request a stop.
  /// \returns signed distances and areas; the errors of set_up_case(), prepare_case() and
  ///   predict_face(); or kNotConverged.
  [[nodiscard]] Result<CaseResidual> evaluate(std::span<const double> values, Progress& progress);

  /// Values of the parameters in the plan of the case, within their bounds; reads the plan.
  [[nodiscard]] Result<std::vector<double>> values_of_plan();

  /// The plan of the case, before parameters are set. \pre values_of_plan() has succeeded.
  [[nodiscard]] const io::PlanFile& plan() const { return *plan_; }

  [[nodiscard]] const std::string& name() const { return one_.name; }

  /// Releases the memory of the prepared prediction.
  void release();

 private:
  struct Face;
  CalibrationCase() = default;
  [[nodiscard]] Result<void> set_up(Progress& progress);
  [[nodiscard]] Result<void> prepare(std::span<const double> values, Progress& progress);
  [[nodiscard]] Result<CaseResidual> predict(std::span<const double> values, Progress& progress);
  [[nodiscard]] std::filesystem::path file_of(std::span<const double> values) const;

  CohortCase one_;
  std::filesystem::path work_;
  SetupOptions setup_options_;
  std::vector<CalibrationParameter> parameters_;
  std::string inputs_sha256_;
  std::optional<CaseSetup> setup_{};
  std::optional<io::PlanFile> plan_{};
  std::optional<PreparedCase> prepared_{};
  std::vector<double> prepared_values_{};
  std::shared_ptr<const Face> face_{};
};

/// Weighted mean of the absolute distances.
///
/// \param residual  of a case.
/// \returns [mm]; NaN if nothing is compared.
[[nodiscard]] double mean_error_mm(const CaseResidual& residual);

}  // namespace lefort::pipeline
