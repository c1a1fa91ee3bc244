#include <lefort/io/output_folder.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/validate.h>
#include <lefort/pipeline/validate/calibration_case.h>
#include <lefort/pipeline/validate/calibration_report.h>
#include <lefort/pipeline/validate/case_plan.h>
#include <lefort/pipeline/validate/cohort_folder.h>
#include <lefort/pipeline/validate/run_case.h>
#include <lefort/report/report_html.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCalibration = "calibration.json";
constexpr const char* kCalibrationTable = "calibration.csv";
constexpr const char* kCalibrationPage = "calibration.html";
constexpr const char* kNoCounterpart =
    "no point of the predicted face has a counterpart after surgery within 20 mm";
constexpr double kCoarse_mm = 4.0;  // Element size, unless the plan's is larger.

/// The cases of a calibration and their residuals.
class CalibrationCohort {
 public:
  CalibrationCohort(const CalibrateJob& job, std::vector<CalibrationParameter> parameters,
                    Progress& progress)
      : job_(job), parameters_(std::move(parameters)), progress_(progress) {}

  /// Opens the cases, and evaluates each with the parameters of its plan.
  [[nodiscard]] Result<void> open(const std::vector<fs::path>& folders, Calibration& calibration);

  [[nodiscard]] Result<CaseResidual> residual(Index number, const VectorX& at);
  [[nodiscard]] std::vector<double> values(const VectorX& at) const;
  [[nodiscard]] VectorX coordinates(const std::vector<double>& values) const;
  [[nodiscard]] Index size() const { return Index(cases_.size()); }
  /// The message of an error, without paths.
  [[nodiscard]] std::string reason(const Error& error) const {
    return without_paths(error.message, job_.cohort, job_.output);
  }
  [[nodiscard]] const CalibrationCase& at(Index number) const {
    return cases_[std::size_t(number)];
  }

 private:
  [[nodiscard]] Result<CalibrationCase> open_case(const fs::path& folder) const;
  /// Error with the parameters of the first case's plan.
  [[nodiscard]] Result<void> try_case(CalibrationCase& one, Calibration& calibration);

  const CalibrateJob& job_;
  std::vector<CalibrationParameter> parameters_;
  Progress& progress_;
  std::vector<CalibrationCase> cases_;
};

/// The plan's element size if it is coarse, or else 4 mm.
Result<double> coarse_size(const CohortCase& one, const fs::path& work) {
  LEFORT_TRY(const CasePlan draft, draft_plan(one, {one.folder, std::nullopt, work}, std::nullopt));
  const double planned_mm = draft.json.value("tissue", nlohmann::ordered_json::object())
                                .value("element_size_mm", predict::TissueOptions{}.element_size_mm);
  return std::max(planned_mm, kCoarse_mm);
}

Result<CalibrationCase> CalibrationCohort::open_case(const fs::path& folder) const {
  LEFORT_TRY(const CohortCase one, find_case(folder));
  const fs::path work = job_.output / "calibration" / one.name;
  SetupOptions setup{job_.achieved_movements, job_.element_size_mm, job_.voxel_mm};
  if (!setup.element_size_mm) {
    LEFORT_TRY(setup.element_size_mm, coarse_size(one, work));
  }
  return CalibrationCase::open(one, work, setup, parameters_);
}

Result<void> CalibrationCohort::try_case(CalibrationCase& one, Calibration& calibration) {
  LEFORT_TRY(const std::vector<double> planned, one.values_of_plan());
  if (cases_.empty()) calibration.start = planned;
  CaseProgress progress(one.name() + ": ", progress_);
  LEFORT_TRY(const CaseResidual residual, one.evaluate(calibration.start, progress));
  if (std::isnan(mean_error_mm(residual)))
    return fail(ErrorCode::kInvalidArgument,
                std::string(kNoCounterpart) + ": are both in the same frame?");
  return {};
}

Result<void> CalibrationCohort::open(const std::vector<fs::path>& folders,
                                     Calibration& calibration) {
  for (const fs::path& folder : folders) {
    Result<CalibrationCase> one = open_case(folder);
    const Result<void> tried =
        one ? try_case(*one, calibration) : Result<void>(tl::unexpected(one.error()));
    if (tried) {
      one->release();
      cases_.push_back(*std::move(one));
      continue;
    }
    if (!is_of_case(tried.error())) return tried;
    calibration.failures.emplace_back(folder.filename().string(), reason(tried.error()));
    progress_.note(fmt::format("failed: {}: {}", calibration.failures.back().first,
                               calibration.failures.back().second));
  }
  if (cases_.size() >= 2) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} of {} cases can be predicted, must be two or more{}", cases_.size(),
                          folders.size(),
                          calibration.failures.empty()
                              ? std::string()
                              : fmt::format("; {}: {}", calibration.failures.front().first,
                                            calibration.failures.front().second)));
}

Result<CaseResidual> CalibrationCohort::residual(Index number, const VectorX& at) {
  // Memory: only one case is prepared at a time.
  for (Index other = 0; other < size(); ++other)
    if (other != number) cases_[std::size_t(other)].release();
  CalibrationCase& one = cases_[std::size_t(number)];
  CaseProgress progress(one.name() + ": ", progress_, CaseNotes::kDrop);
  return one.evaluate(values(at), progress);
}

std::vector<double> CalibrationCohort::values(const VectorX& at) const {
  std::vector<double> values;
  for (Index p = 0; p < at.size(); ++p) values.push_back(parameters_[std::size_t(p)].value(at[p]));
  return values;
}

VectorX CalibrationCohort::coordinates(const std::vector<double>& values) const {
  VectorX at(Index(values.size()));
  for (Index p = 0; p < at.size(); ++p)
    at[p] = parameters_[std::size_t(p)].coordinate(values[std::size_t(p)]);
  return at;
}

FittedValues fitted_values(const CalibrationCohort& cohort, const ParameterFit& fit,
                           const compare::BootstrapOptions& bootstrap) {
  FittedValues fitted{cohort.values(fit.at), {}, fit.iterations, fit.converged};
  VectorX low = fit.at, high = fit.at;
  const auto intervals = fit_intervals(fit, bootstrap);
  for (std::size_t p = 0; p < intervals.size(); ++p) {
    low[Index(p)] = intervals[p].low;
    high[Index(p)] = intervals[p].high;
  }
  const std::vector<double> lows = cohort.values(low), highs = cohort.values(high);
  for (std::size_t p = 0; p < lows.size(); ++p) fitted.intervals.push_back({lows[p], highs[p]});
  return fitted;
}

/// One line for the log.
std::string describe(const Calibration& calibration) {
  std::string text = "fitted to all cases:";
  for (std::size_t p = 0; p < calibration.parameters.size(); ++p)
    text += fmt::format("{} {} {:.3g} ({:.3g} to {:.3g})", p == 0 ? "" : ",",
                        calibration.parameters[p].name, calibration.all.values[p],
                        calibration.all.intervals[p].low, calibration.all.intervals[p].high);
  return text;
}

/// Mean error of cases [mm].
Result<double> mean_error_of(CalibrationCohort& cohort, std::span<const Index> cases,
                             const VectorX& at) {
  double sum = 0.0;
  for (const Index number : cases) {
    LEFORT_TRY(const CaseResidual residual, cohort.residual(number, at));
    sum += mean_error_mm(residual);
  }
  return sum / double(cases.size());
}

CohortValue mean_with_interval(const std::vector<double>& values,
                               const compare::BootstrapOptions& bootstrap) {
  const auto mean = [&](std::span<const Index> chosen) {
    double sum = 0.0;
    for (const Index k : chosen) sum += values[std::size_t(k)];
    return sum / double(chosen.size());
  };
  std::vector<Index> all(values.size());
  std::iota(all.begin(), all.end(), Index{0});
  return {mean(all), compare::bootstrap_interval(Index(values.size()), mean, bootstrap)};
}

/// Errors of a held-out case. If its prediction fails, the fold has the reason.
Result<void> evaluate_held_out(CalibrationCohort& cohort, Index out, const VectorX& start,
                               const VectorX& fitted, CalibrationFold& fold) {
  const std::array<Index, 1> alone{out};
  LEFORT_TRY(fold.start_error_mm, mean_error_of(cohort, alone, start));
  const Result<double> error_mm = mean_error_of(cohort, alone, fitted);
  if (!error_mm && error_mm.error().code != ErrorCode::kNotConverged)
    return tl::unexpected(error_mm.error());
  fold.held_out_error_mm = error_mm.value_or(NAN);
  if (std::isfinite(fold.held_out_error_mm)) return {};
  fold.failure = error_mm ? std::string(kNoCounterpart) : cohort.reason(error_mm.error());
  return {};
}

/// Fits all cases, then all without each one, starting from the fit of all.
Result<void> fit_and_validate(CalibrationCohort& cohort, const FitOptions& options,
                              Calibration& calibration, Progress& progress) {
  FitProblem problem;
  for (const CalibrationParameter& one : calibration.parameters)
    problem.difference_step.push_back(one.coordinate_step());
  problem.residual = [&](Index number, const VectorX& at) { return cohort.residual(number, at); };
  problem.is_of_case = is_of_case;
  std::vector<Index> all(std::size_t(cohort.size()));
  std::iota(all.begin(), all.end(), Index{0});
  const VectorX start = cohort.coordinates(calibration.start);
  progress.note("fit to all cases");
  LEFORT_TRY(const ParameterFit fit, fit_parameters(problem, all, start, options));
  calibration.all = fitted_values(cohort, fit, calibration.bootstrap);
  progress.note(describe(calibration));
  LEFORT_TRY(calibration.start_error_mm, mean_error_of(cohort, all, start));
  LEFORT_TRY(calibration.fit_error_mm, mean_error_of(cohort, all, fit.at));
  std::vector<double> held_out_mm, gains_mm;
  for (const Index out : all) {
    progress.note(fmt::format("fit without {}", cohort.at(out).name()));
    std::vector<Index> others = all;
    std::erase(others, out);
    LEFORT_TRY(const ParameterFit fold, fit_parameters(problem, others, fit.at, options));
    CalibrationFold line{.held_out = cohort.at(out).name(),
                         .fitted = fitted_values(cohort, fold, calibration.bootstrap)};
    LEFORT_TRY(line.fit_error_mm, mean_error_of(cohort, others, fold.at));
    LEFORT_TRY_VOID(evaluate_held_out(cohort, out, start, fold.at, line));
    if (line.failure.empty()) {
      held_out_mm.push_back(line.held_out_error_mm);
      gains_mm.push_back(line.start_error_mm - line.held_out_error_mm);
    } else {
      progress.note(fmt::format("failed: {}: {}", line.held_out, line.failure));
    }
    calibration.folds.push_back(std::move(line));
  }
  if (held_out_mm.empty())
    return fail(ErrorCode::kNotConverged,
                fmt::format("no held-out case has an error with the parameters that were fitted "
                            "without it; {}: {}",
                            calibration.folds.back().held_out, calibration.folds.back().failure));
  calibration.held_out_mm = mean_with_interval(held_out_mm, calibration.bootstrap);
  calibration.gain_mm = mean_with_interval(gains_mm, calibration.bootstrap);
  return {};
}

Result<Summary> write_calibration(const CalibrateJob& job, const Calibration& calibration) {
  const auto json = calibration_json(calibration);
  LEFORT_TRY_VOID(io::write_text(job.output / kCalibrationTable, calibration_csv(calibration)));
  LEFORT_TRY_VOID(io::write_text(job.output / kCalibration, json.dump(2) + "\n"));
  LEFORT_TRY_VOID(io::write_text(job.output / kCalibrationPage,
                                 report::report_html(calibration_page(calibration))));
  return Summary{job.output.string() + ": " + calibration_text(calibration), json};
}

}  // namespace

Result<Summary> calibrate_cohort(const CalibrateJob& job, Progress& progress) {
  Calibration calibration;
  const auto names = job.parameters.empty() ? default_parameters() : job.parameters;
  LEFORT_TRY(calibration.parameters, find_parameters(names));
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY(const std::vector<fs::path> folders,
             open_cohort(job.cohort, job.output,
                         std::array{kCalibrationPage, kCalibration, kCalibrationTable}));
  CalibrationCohort cohort(job, calibration.parameters, progress);
  LEFORT_TRY_VOID(cohort.open(folders, calibration));
  LEFORT_TRY_VOID(
      fit_and_validate(cohort, {.max_iterations = job.max_iterations}, calibration, progress));
  calibration.plan_keys = nlohmann::ordered_json::object();
  for (std::size_t p = 0; p < calibration.parameters.size(); ++p)
    calibration.plan_keys.merge_patch(
        calibration.parameters[p].keys(cohort.at(0).plan(), calibration.all.values[p]));
  progress.begin_stage("write the report");
  return write_calibration(job, calibration);
}

}  // namespace lefort::pipeline
