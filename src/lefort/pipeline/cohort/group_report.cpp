#include <lefort/core/version.h>
#include <lefort/pipeline/cohort/group_report.h>
#include <lefort/pipeline/validate/cohort_report.h>

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <utility>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

bool is_predicted(const GroupRow& row) { return row.found.state == EvaluationState::kPredicted; }

/// Mean distance of a method to the achieved skin over the face; NaN if it is not compared.
double face_error_mm(const GroupRow& row, std::size_t method) {
  if (!is_predicted(row)) return kNoValue;
  for (const RegionResult& region : row.found.evaluation.comparison.regions)
    if (region.region == "face") return region.methods[method][0];
  return kNoValue;
}

Json row_json(const GroupRow& row) {
  const Evaluation& one = row.found.evaluation;
  Json json{{"participant", row.participant},
            {"set", row.set},
            {"state", name_of(row.found.state)},
            {"reason", is_predicted(row) ? Json() : Json(row.found.reason)},
            {"skin", Json()},
            {"difference_to_first_set", Json()},
            {"face_error_mm", finite_or_null(face_error_mm(row, 0))},
            {"face_error_no_change_mm", finite_or_null(face_error_mm(row, 1))}};
  if (is_predicted(row))
    json["skin"] = {{"max_shift_mm", one.max_shift_mm},
                    {"mean_shift_where_moved_mm", one.mean_shift_where_moved_mm}};
  if (row.difference)
    json["difference_to_first_set"] = {
        {"max_mm", row.difference->max_mm},
        {"mean_where_above_half_mm", row.difference->mean_over_moved_mm}};
  return json;
}

Json set_json(const GroupSet& of_set) {
  Json regions = Json::array();
  for (const CohortRegion& region : of_set.regions) regions.push_back(region_json(region));
  return {{"set", of_set.set.name},
          {"overrides", nlohmann::json::parse(of_set.set.overrides)},
          {"predicted", of_set.predicted},
          {"failed", of_set.failed},
          {"missing", of_set.missing},
          {"compared", of_set.compared},
          {"skin",
           {{"max_shift_mm", value_json(of_set.max_shift_mm)},
            {"mean_shift_where_moved_mm", value_json(of_set.mean_shift_mm)}}},
          {"difference_to_first_set",
           {{"max_mm", value_json(of_set.max_difference_mm)},
            {"mean_where_above_half_mm", value_json(of_set.mean_difference_mm)}}},
          {"regions", regions}};
}

report::ReportTable sets_table(const GroupResults& results) {
  report::ReportTable table{
      .title = "Parameter sets: mean over cases, with 95 % interval",
      .heads = {"set", "predicted", "failed", "missing", "largest displacement of the skin [mm]",
                "largest difference to the first set [mm]", "error of the face [mm]",
                "error without prediction [mm]"},
      .rows = {}};
  for (const GroupSet& one : results.sets) {
    std::string face = "-", unchanged = "-";
    for (const CohortRegion& region : one.regions)
      if (region.region == "face") {
        face = in_words(region.methods[0][0], 2);
        unchanged = in_words(region.methods[1][0], 2);
      }
    table.rows.push_back({one.set.name, std::to_string(one.predicted), std::to_string(one.failed),
                          std::to_string(one.missing), in_words(one.max_shift_mm, 2),
                          in_words(one.max_difference_mm, 2), face, unchanged});
  }
  return table;
}

report::ReportTable overrides_table(const GroupResults& results) {
  report::ReportTable table{
      .title = "Changes of the plans", .heads = {"set", "keys with other values"}, .rows = {}};
  for (const GroupSet& one : results.sets)
    table.rows.push_back({one.set.name, one.set.overrides == "{}" ? "none" : one.set.overrides});
  return table;
}

report::ReportTable unfinished_table(const GroupResults& results) {
  report::ReportTable table{.title = "Evaluations without a prediction",
                            .heads = {"case", "set", "state", "reason"},
                            .rows = {}};
  for (const GroupRow& row : results.rows)
    if (!is_predicted(row))
      table.rows.push_back(
          {"sub-" + row.participant, row.set, name_of(row.found.state), row.found.reason});
  return table;
}

/// One value per case: a row per case, a column per set.
template <class Value>
report::ReportTable cases_table(const GroupResults& results, const std::string& title,
                                const Value& value) {
  report::ReportTable table{.title = title, .heads = {"case"}, .rows = {}};
  for (const GroupSet& one : results.sets) table.heads.push_back(one.set.name);
  for (const GroupRow& row : results.rows) {
    if (table.rows.empty() || table.rows.back().front() != "sub-" + row.participant)
      table.rows.push_back({"sub-" + row.participant});
    const double mm = value(row);
    table.rows.back().push_back(std::isfinite(mm) ? fmt::format("{:.2f}", mm) : "-");
  }
  return table;
}

double max_shift_mm(const GroupRow& row) {
  return is_predicted(row) ? row.found.evaluation.max_shift_mm : kNoValue;
}

double max_difference_mm(const GroupRow& row) {
  return row.difference ? row.difference->max_mm : kNoValue;
}

/// A point per case, one color per set.
template <class Value>
report::LinePlot cases_plot(const GroupResults& results, const std::string& title,
                            const std::string& y_label, const Value& value) {
  report::LinePlot plot{.title = title, .x_label = "number of the case", .y_label = y_label};
  for (const GroupSet& one : results.sets) {
    report::PlotLine line{.name = one.set.name, .points_only = true};
    double number = 0.0;
    for (const GroupRow& row : results.rows) {
      if (row.set != one.set.name) continue;
      number += 1.0;
      if (!std::isfinite(value(row))) continue;
      line.x.push_back(number);
      line.y.push_back(value(row));
    }
    if (!line.x.empty()) plot.lines.push_back(std::move(line));
  }
  return plot;
}

bool has_comparison(const GroupResults& results) {
  for (const GroupSet& one : results.sets)
    if (one.compared > 0) return true;
  return false;
}

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format(",{:.4f}", value) : std::string(",");
}

}  // namespace

Json group_json(const GroupResults& results) {
  Json json{{"lefort_group", 1},
            {"notice", kNotForClinicalUse},
            {"version", kVersion},
            {"bootstrap",
             {{"replicates", results.bootstrap.replicates},
              {"level", results.bootstrap.level},
              {"seed", results.bootstrap.seed}}},
            {"participants", results.participants.size()},
            {"evaluations_total", results.rows.size()},
            {"evaluations_predicted", results.count(EvaluationState::kPredicted)},
            {"evaluations_failed", results.count(EvaluationState::kFailed)},
            {"evaluations_missing",
             results.count(EvaluationState::kMissing) + results.count(EvaluationState::kOutdated)},
            {"sets", Json::array()},
            {"evaluations", Json::array()}};
  for (const GroupSet& one : results.sets) json["sets"].push_back(set_json(one));
  for (const GroupRow& row : results.rows) json["evaluations"].push_back(row_json(row));
  return json;
}

std::string group_csv(const GroupResults& results) {
  std::string csv =
      "participant,set,state,reason,max_shift_mm,mean_shift_where_moved_mm,"
      "max_difference_to_first_set_mm,mean_difference_to_first_set_mm,face_error_mm,"
      "face_error_no_change_mm,face_error_ratio_rule_mm\n";
  for (const GroupRow& row : results.rows) {
    const Evaluation& one = row.found.evaluation;
    csv += fmt::format("{},{},{},{}", row.participant, row.set, name_of(row.found.state),
                       csv_field(row.found.reason));
    csv += cell(max_shift_mm(row));
    csv += cell(is_predicted(row) ? one.mean_shift_where_moved_mm : kNoValue);
    csv += cell(max_difference_mm(row));
    csv += cell(row.difference ? row.difference->mean_over_moved_mm : kNoValue);
    for (std::size_t m = 0; m < kMethods.size(); ++m) csv += cell(face_error_mm(row, m));
    csv += "\n";
  }
  return csv;
}

std::string regions_csv(const GroupResults& results) {
  std::string csv;
  for (const GroupSet& one : results.sets) {
    CohortResults of_set;
    for (CaseResult& result : cases_of(results, one.set.name))
      if (!result.failure) of_set.cases.push_back(std::move(result));
    std::istringstream lines(cohort_csv(of_set));
    std::string line;
    std::getline(lines, line);
    if (csv.empty()) csv = "set," + line + "\n";
    while (std::getline(lines, line)) csv += one.set.name + "," + line + "\n";
  }
  return csv;
}

std::vector<std::pair<std::string, report::LinePlot>> group_plots(const GroupResults& results) {
  std::vector<std::pair<std::string, report::LinePlot>> plots;
  const auto add = [&](const char* file, report::LinePlot plot) {
    if (!plot.lines.empty()) plots.emplace_back(file, std::move(plot));
  };
  add("displacement.svg", cases_plot(results, "Largest displacement of the skin",
                                     "largest displacement [mm]", max_shift_mm));
  add("difference.svg",
      cases_plot(results, "Largest difference of the skin to that of the first set",
                 "largest difference [mm]", max_difference_mm));
  add("error.svg", cases_plot(results, "Error of the face", "mean distance [mm]",
                              [](const GroupRow& row) { return face_error_mm(row, 0); }));
  return plots;
}

report::CaseReport group_report(const GroupResults& results) {
  report::CaseReport report;
  const Index predicted = results.count(EvaluationState::kPredicted);
  report.title = fmt::format("Predictions of {} cases with {} parameter sets",
                             results.participants.size(), results.sets.size());
  report.subtitle = "Simulated soft-tissue response to planned bone movements";
  report.plan = fmt::format("{} of {} evaluations are predicted.", predicted, results.rows.size());
  report.converged = true;
  report.key_numbers = {{"predicted", fmt::format("{} of {}", predicted, results.rows.size())},
                        {"failed", std::to_string(results.count(EvaluationState::kFailed))},
                        {"missing", std::to_string(results.count(EvaluationState::kMissing) +
                                                   results.count(EvaluationState::kOutdated))}};
  report.tables = {sets_table(results), overrides_table(results)};
  if (predicted < Index(results.rows.size())) report.tables.push_back(unfinished_table(results));
  report.tables.push_back(
      cases_table(results, "Largest displacement of the skin [mm]", max_shift_mm));
  if (results.sets.size() > 1)
    report.tables.push_back(
        cases_table(results, "Largest difference of the skin to that of the first set [mm]",
                    max_difference_mm));
  if (has_comparison(results))
    report.tables.push_back(
        cases_table(results, "Mean distance of the predicted face to the achieved face [mm]",
                    [](const GroupRow& row) { return face_error_mm(row, 0); }));
  for (auto& [file, plot] : group_plots(results)) report.plots.push_back(std::move(plot));
  report.plots_heading = "Cases";
  report.notes = {
      "An evaluation is the prediction of one case with one parameter set. The first set is the "
      "reference of the differences, vertex by vertex of the skin.",
      fmt::format("Intervals: percentile bootstrap over cases, {} replicates, seed {} (Efron and "
                  "Tibshirani 1993). A cohort of fewer than about ten cases has unreliable "
                  "intervals.",
                  results.bootstrap.replicates, results.bootstrap.seed)};
  if (has_comparison(results))
    report.notes.push_back(
        "Error: distance to the closest point of the skin after surgery, as in `lefort validate`; "
        "regions.csv has all regions and methods.");
  report.limitations = {
      "A difference between parameter sets shows how much the prediction depends on the "
      "parameters, not how accurate it is."};
  return report;
}

std::string group_text(const GroupResults& results) {
  std::string text = fmt::format(
      "{} of {} evaluations predicted, {} failed, {} missing",
      results.count(EvaluationState::kPredicted), results.rows.size(),
      results.count(EvaluationState::kFailed),
      results.count(EvaluationState::kMissing) + results.count(EvaluationState::kOutdated));
  for (const GroupRow& row : results.rows)
    if (!is_predicted(row))
      text += fmt::format("\n  sub-{}, set {}: {}: {}", row.participant, row.set,
                          name_of(row.found.state), row.found.reason);
  return text;
}

}  // namespace lefort::pipeline
