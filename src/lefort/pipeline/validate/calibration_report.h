/// \file
/// The result of a calibration as JSON, CSV, HTML and text.
#pragma once

#include <lefort/pipeline/validate/calibration_parameters.h>
#include <lefort/pipeline/validate/cohort_statistics.h>
#include <lefort/report/case_report.h>

#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// Values of all parameters after a fit.
struct FittedValues {
  std::vector<double> values;
  std::vector<compare::Interval> intervals;  ///< Bootstrap over the cases of the fit.
  int iterations = 0;
  bool converged = false;
};

/// A fit without one case. Errors are mean distances in the regions of the face [mm].
struct CalibrationFold {
  std::string held_out;  ///< Name of the case.
  FittedValues fitted;
  double fit_error_mm = 0.0;  ///< Mean over the other cases.
  /// Of the case, with parameters that were fitted without it; NaN if that failed.
  double held_out_error_mm = 0.0;
  std::string failure = {};     ///< Why that failed, or empty.
  double start_error_mm = 0.0;  ///< Of the case, with Calibration::start.
};

struct Calibration {
  std::vector<CalibrationParameter> parameters;
  std::vector<double> start;                        ///< Values of the first case's plan.
  FittedValues all;                                 ///< Fit to all cases.
  double start_error_mm = 0.0, fit_error_mm = 0.0;  ///< Means over all cases.
  CohortValue held_out_mm{};                        ///< Mean of the finite held-out errors.
  CohortValue gain_mm{};  ///< Mean of start minus held-out error, case by case.
  std::vector<CalibrationFold> folds;
  /// Cases without a prediction, and the reason; they are not part of any fit.
  std::vector<std::pair<std::string, std::string>> failures;
  compare::BootstrapOptions bootstrap;
  nlohmann::ordered_json plan_keys;  ///< Keys of a plan with the fitted values.
};

[[nodiscard]] nlohmann::ordered_json calibration_json(const Calibration& calibration);
[[nodiscard]] std::string calibration_csv(const Calibration& calibration);
[[nodiscard]] report::CaseReport calibration_page(const Calibration& calibration);
[[nodiscard]] std::string calibration_text(const Calibration& calibration);

}  // namespace lefort::pipeline
