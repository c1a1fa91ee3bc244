#include <lefort/core/version.h>
#include <lefort/pipeline/validate/calibration_report.h>
#include <lefort/pipeline/validate/case_result.h>
#include <lefort/pipeline/validate/cohort_report.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json fitted_json(const Calibration& calibration, const FittedValues& fitted) {
  Json json{{"iterations", fitted.iterations}, {"converged", fitted.converged}};
  for (std::size_t p = 0; p < fitted.values.size(); ++p)
    json["parameters"][calibration.parameters[p].name] = {
        {"value", fitted.values[p]},
        {"low", finite_or_null(fitted.intervals[p].low)},
        {"high", finite_or_null(fitted.intervals[p].high)}};
  return json;
}

Json cohort_value_json(const CohortValue& value) {
  return {{"mean", finite_or_null(value.mean)},
          {"low", finite_or_null(value.interval.low)},
          {"high", finite_or_null(value.interval.high)}};
}

std::vector<std::string> values_in_words(const FittedValues& fitted) {
  std::vector<std::string> words;
  for (std::size_t p = 0; p < fitted.values.size(); ++p)
    words.push_back(in_words(CohortValue{fitted.values[p], fitted.intervals[p]}, 2));
  return words;
}

report::ReportTable parameters_table(const Calibration& calibration) {
  report::ReportTable table{
      .title = "Parameters fitted to all cases, with 95 % interval over cases",
      .heads = {"parameter", "meaning", "bounds", "start", "fitted"},
      .rows = {}};
  const auto words = values_in_words(calibration.all);
  for (std::size_t p = 0; p < words.size(); ++p) {
    const CalibrationParameter& one = calibration.parameters[p];
    table.rows.push_back({one.name, one.meaning, fmt::format("{:g} to {:g}", one.low, one.high),
                          fmt::format("{:.2f}", calibration.start[p]), words[p]});
  }
  return table;
}

report::ReportTable folds_table(const Calibration& calibration) {
  report::ReportTable table{
      .title = "Leave one out: each case with parameters fitted to the others [mm]",
      .heads = {"case held out", "held-out error", "fit error of the others", "error at the start"},
      .rows = {}};
  for (const CalibrationParameter& one : calibration.parameters) table.heads.emplace_back(one.name);
  for (const CalibrationFold& fold : calibration.folds) {
    table.rows.push_back(
        {fold.held_out,
         std::isfinite(fold.held_out_error_mm) ? fmt::format("{:.3f}", fold.held_out_error_mm)
                                               : std::string("failed"),
         fmt::format("{:.3f}", fold.fit_error_mm), fmt::format("{:.3f}", fold.start_error_mm)});
    for (const std::string& words : values_in_words(fold.fitted))
      table.rows.back().push_back(words);
  }
  return table;
}

/// Cases that were not fitted, then held-out cases that failed, with the reasons.
std::vector<std::array<std::string, 2>> all_failures(const Calibration& calibration) {
  std::vector<std::array<std::string, 2>> all;
  for (const auto& [name, reason] : calibration.failures) all.push_back({name, reason});
  for (const CalibrationFold& fold : calibration.folds)
    if (!fold.failure.empty())
      all.push_back({fold.held_out,
                     "with the parameters that were fitted without this case: " + fold.failure});
  return all;
}

/// How many cases were fitted, and how many failed.
std::string counts(const Calibration& calibration) {
  const auto held_out = all_failures(calibration).size() - calibration.failures.size();
  return fmt::format("{} cases fitted, {} not fitted, {} failed when held out",
                     calibration.folds.size(), calibration.failures.size(), held_out);
}

}  // namespace

Json calibration_json(const Calibration& calibration) {
  Json json{{"lefort_calibration", 1}, {"notice", kNotForClinicalUse}, {"version", kVersion}};
  json["bootstrap"] = {{"replicates", calibration.bootstrap.replicates},
                       {"level", calibration.bootstrap.level},
                       {"seed", calibration.bootstrap.seed}};
  json["parameters"] = json["folds"] = json["failures"] = Json::array();
  for (std::size_t p = 0; p < calibration.parameters.size(); ++p) {
    const CalibrationParameter& one = calibration.parameters[p];
    json["parameters"].push_back({{"name", one.name},
                                  {"meaning", one.meaning},
                                  {"low", one.low},
                                  {"high", one.high},
                                  {"start", calibration.start[p]}});
  }
  json["all_cases"] = fitted_json(calibration, calibration.all);
  json["start_error_mm"] = finite_or_null(calibration.start_error_mm);
  json["fit_error_mm"] = finite_or_null(calibration.fit_error_mm);
  json["held_out_error_mm"] = cohort_value_json(calibration.held_out_mm);
  json["gain_mm"] = cohort_value_json(calibration.gain_mm);
  for (const CalibrationFold& fold : calibration.folds) {
    Json line = fitted_json(calibration, fold.fitted);
    line["held_out"] = fold.held_out;
    line["held_out_error_mm"] = finite_or_null(fold.held_out_error_mm);
    line["fit_error_mm"] = finite_or_null(fold.fit_error_mm);
    line["start_error_mm"] = finite_or_null(fold.start_error_mm);
    json["folds"].push_back(std::move(line));
  }
  for (const auto& [name, reason] : all_failures(calibration))
    json["failures"].push_back({{"case", name}, {"reason", reason}});
  json["plan_keys"] = calibration.plan_keys;
  return json;
}

std::string calibration_csv(const Calibration& calibration) {
  std::string csv = "held_out,held_out_error_mm,fit_error_mm,start_error_mm";
  for (const CalibrationParameter& one : calibration.parameters)
    csv += fmt::format(",{0},{0}_low,{0}_high", one.name);
  csv += "\n";
  const auto line = [&](const std::string& name, double held_out_mm, double fit_mm, double start_mm,
                        const FittedValues& fitted) {
    const auto cell = [](double value) {
      return std::isfinite(value) ? fmt::format(",{:.5f}", value) : std::string(",");
    };
    csv += csv_field(name) + cell(held_out_mm) + cell(fit_mm) + cell(start_mm);
    for (std::size_t p = 0; p < fitted.values.size(); ++p)
      csv +=
          cell(fitted.values[p]) + cell(fitted.intervals[p].low) + cell(fitted.intervals[p].high);
    csv += "\n";
  };
  for (const CalibrationFold& fold : calibration.folds)
    line(fold.held_out, fold.held_out_error_mm, fold.fit_error_mm, fold.start_error_mm,
         fold.fitted);
  line("(none)", NAN, calibration.fit_error_mm, calibration.start_error_mm, calibration.all);
  return csv;
}

report::CaseReport calibration_page(const Calibration& calibration) {
  report::CaseReport report;
  report.title = fmt::format("Calibration on {} cases", calibration.folds.size());
  report.subtitle = "Parameters fitted to achieved faces, with cross-validation";
  report.plan = counts(calibration) + ".";
  report.converged = true;
  report.key_numbers = {{"mean held-out error", in_words(calibration.held_out_mm, 2) + " mm"},
                        {"mean error with the parameters of the plans",
                         fmt::format("{:.2f} mm", calibration.start_error_mm)},
                        {"gain on held-out cases", in_words(calibration.gain_mm, 2) + " mm"},
                        {"mean error of the fit (not a measure of accuracy)",
                         fmt::format("{:.2f} mm", calibration.fit_error_mm)}};
  report.tables = {parameters_table(calibration), folds_table(calibration)};
  if (const auto all = all_failures(calibration); !all.empty()) {
    report::ReportTable failures{
        .title = "Cases that failed", .heads = {"case", "reason"}, .rows = {}};
    for (const auto& [name, reason] : all) failures.rows.push_back({name, reason});
    report.tables.push_back(std::move(failures));
  }
  report.notes = {
      "The fit minimizes the mean over cases of the mean square distance to the achieved skin, in "
      "all regions of the face (Gauss-Newton with damping and finite differences, bounded).",
      fmt::format(
          "Intervals: percentile bootstrap over cases, {} replicates, seed {}; of parameters "
          "with linearized residuals.",
          calibration.bootstrap.replicates, calibration.bootstrap.seed),
      "Errors are means of the absolute distance in all regions of the face."};
  for (const CalibrationFold& fold : calibration.folds)
    if (!fold.fitted.converged)
      report.notes.push_back(fmt::format("The fit without {} did not converge in {} iterations.",
                                         fold.held_out, fold.fitted.iterations));
  return report;
}

std::string calibration_text(const Calibration& calibration) {
  std::string text =
      fmt::format("{}\n  mean error: {:.3f} mm at the start, {:.3f} mm fitted, {} mm held out",
                  counts(calibration), calibration.start_error_mm, calibration.fit_error_mm,
                  in_words(calibration.held_out_mm, 3));
  const auto words = values_in_words(calibration.all);
  for (std::size_t p = 0; p < words.size(); ++p)
    text += fmt::format("\n  {}: {}", calibration.parameters[p].name, words[p]);
  for (const auto& [name, reason] : all_failures(calibration))
    text += fmt::format("\n  failed: {}: {}", name, reason);
  return text;
}

}  // namespace lefort::pipeline
