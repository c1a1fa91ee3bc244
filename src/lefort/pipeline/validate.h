/// \file
/// Validation of predictions on a cohort of patients, and calibration of their parameters.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct ValidateJob {
  std::filesystem::path cohort;  ///< A folder of case folders: docs/guide/validate.md.
  std::filesystem::path output;  ///< A folder; created if missing. Not inside the cohort.
  /// Movements found in the bone after surgery, instead of those of the plans.
  bool achieved_movements = false;
  std::optional<double> element_size_mm{};  ///< Instead of the plans'; > 0.
  /// Voxel edge of the scan that is computed for a case that has only surfaces; > 0.
  double voxel_mm = 1.0;
  bool pictures = true;
};

/// Predicts each case of a cohort and compares it with the achieved face; writes validation.json,
/// validation.csv, report.html and pictures/. A case that fails is reported with its reason. The
/// results of cases are stored: a run that was stopped resumes, and writes the same bytes.
///
/// \returns the summary; or
///   - kFileNotFound     the cohort does not exist;
///   - kInvalidArgument  the cohort has no case, or one of cohort and output contains the other;
///   - kFileUnwritable   a result could not be written;
///   - kOutOfMemory      a case needs more memory than available;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<Summary> validate_cohort(const ValidateJob& job, Progress& progress);

struct CalibrateJob {
  std::filesystem::path cohort;           ///< As for ValidateJob.
  std::filesystem::path output;           ///< A folder; created if missing. Not inside the cohort.
  bool achieved_movements = false;        ///< As for ValidateJob.
  std::vector<std::string> parameters{};  ///< Names; empty: default_parameters().
  /// Default: 4 mm, or the element size of the plan if that is larger.
  std::optional<double> element_size_mm{};
  double voxel_mm = 1.0;   ///< As for ValidateJob.
  int max_iterations = 8;  ///< Of each fit; >= 1.
};

/// Fits parameters of the prediction to a cohort, and to the cohort without each case in turn;
/// writes calibration.json, calibration.csv and calibration.html. Evaluations are stored: a run
/// that was stopped resumes, and writes the same bytes.
///
/// \returns the summary; the errors of validate_cohort() and fit_parameters(); kInvalidArgument for
///   an unknown or repeated parameter or fewer than two cases that can be predicted; or the error
///   of a case that cannot be predicted with the values fitted without it.
[[nodiscard]] Result<Summary> calibrate_cohort(const CalibrateJob& job, Progress& progress);

struct PhantomCohortJob {
  std::filesystem::path output;  ///< A folder; created if missing; must be empty.
  int cases = 10;                ///< >= 1.
  double voxel_mm = 2.0;         ///< Of the scans; > 0.
  double noise_hu = 12.0;        ///< Standard deviation of the noise of the scans.
  double skin_noise_mm = 0.3;    ///< Standard deviation of the measured skin after surgery.
  double element_size_mm = 5.0;  ///< Of the plans.
  std::uint64_t seed = 1;
};

/// Writes a cohort of synthetic cases: a scan before surgery, a plan, the skin after surgery, and
/// truth.json with the parameters that the faces were made with. A case that cannot be predicted is
/// drawn again, up to 20 times.
///
/// \returns the summary, or
///   - kFileUnwritable  the output is not empty, or a file cannot be written;
///   - the errors of prepare_case() and predict::predict_face(), kNotConverged, or kCancelled.
[[nodiscard]] Result<Summary> make_phantom_cohort(const PhantomCohortJob& job, Progress& progress);

}  // namespace lefort::pipeline
