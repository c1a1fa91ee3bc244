#include <lefort/core/version.h>
#include <lefort/pipeline/validate/cohort_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kMethodNames{"prediction", "no change", "ratio rule"};

std::size_t failures_of(const CohortResults& results) {
  return std::size_t(std::count_if(results.cases.begin(), results.cases.end(),
                                   [](const CaseResult& one) { return one.failure.has_value(); }));
}

std::string fixed(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

report::ReportTable methods_table(const CohortResults& results) {
  report::ReportTable table{
      .title = "Mean distance to the achieved skin [mm]: mean over cases, with 95 % interval",
      .heads = {"region", "cases", "prediction", "no change", "ratio rule", "gain over no change",
                "gain over ratio rule"},
      .rows = {}};
  for (const CohortRegion& region : results.regions)
    table.rows.push_back({region.region, std::to_string(region.cases),
                          in_words(region.methods[0][0], 2), in_words(region.methods[1][0], 2),
                          in_words(region.methods[2][0], 2), in_words(region.gain_mm[1], 2),
                          in_words(region.gain_mm[2], 2)});
  return table;
}

report::ReportTable statistics_table(const CohortResults& results, std::size_t method) {
  report::ReportTable table{
      .title = fmt::format("Of the {}: mean over cases, with 95 % interval", kMethodNames[method]),
      .heads = {"region", "median [mm]", "P90 [mm]", "below 1 mm [%]", "below 2 mm [%]",
                "signed along x, to the left [mm]", "along y, posterior [mm]",
                "along z, superior [mm]"},
      .rows = {}};
  const auto percent = [](CohortValue value) {
    for (double* part : {&value.mean, &value.interval.low, &value.interval.high}) *part *= 100.0;
    return in_words(value, 0);
  };
  for (const CohortRegion& region : results.regions) {
    const auto& s = region.methods[method];
    table.rows.push_back({region.region, in_words(s[1], 2), in_words(s[2], 2), percent(s[3]),
                          percent(s[4]), in_words(s[6], 2), in_words(s[7], 2), in_words(s[8], 2)});
  }
  return table;
}

report::ReportTable success_table(const CohortResults& results) {
  report::ReportTable table{
      .title =
          "Cases whose mean error is within a limit, and agreement of the displacement along y "
          "(predicted minus achieved)",
      .heads = {"region", "within 1 mm [%]", "within 2 mm [%]", "bias [mm]",
                "lower limit of agreement [mm]", "upper limit of agreement [mm]"},
      .rows = {}};
  for (const CohortRegion& region : results.regions) {
    const compare::Agreement& a = region.agreement_y;
    table.rows.push_back({region.region, fixed(100.0 * region.cases_within_1mm_fraction, 0),
                          fixed(100.0 * region.cases_within_2mm_fraction, 0), fixed(a.bias, 2),
                          fixed(a.limits.low, 2), fixed(a.limits.high, 2)});
  }
  return table;
}

const RegionResult* region_of_case(const CaseResult& result, const std::string& name) {
  for (const RegionResult& region : result.regions)
    if (region.region == name) return &region;
  return nullptr;
}

report::ReportTable cases_table(const CohortResults& results) {
  report::ReportTable table{
      .title = "Mean error of the prediction of each case [mm]", .heads = {"case"}, .rows = {}};
  for (const CohortRegion& region : results.regions) table.heads.push_back(region.region);
  table.heads.insert(table.heads.end(), {"no change (face)", "ratio rule (face)", "movement [mm]",
                                         "movement from", "regions from", "registered on"});
  for (const CaseResult& one : results.cases) {
    if (one.failure) continue;
    std::vector<std::string> row{one.name};
    for (const CohortRegion& region : results.regions) {
      const RegionResult* const found = region_of_case(one, region.region);
      row.push_back(found == nullptr ? "-" : fixed(found->methods[0][0], 2));
    }
    const RegionResult* const face = region_of_case(one, "face");
    for (const std::size_t m : {1U, 2U})
      row.push_back(face == nullptr ? "-" : fixed(face->methods[m][0], 2));
    std::string moved;
    for (const SegmentMovement& segment : one.segments)
      moved +=
          fmt::format("{}{} {:.1f}", moved.empty() ? "" : ", ", segment.segment, segment.max_mm);
    row.insert(row.end(), {moved, one.movement, one.regions_from, one.registered_on});
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::ReportTable failures_table(const CohortResults& results) {
  report::ReportTable table{.title = "Cases that failed", .heads = {"case", "reason"}, .rows = {}};
  for (const CaseResult& one : results.cases)
    if (one.failure) table.rows.push_back({one.name, *one.failure});
  return table;
}

/// Differences over means of the displacement along y, with bias and limits \cite bland1986.
report::LinePlot agreement_plot(const CohortResults& results, const CohortRegion& region) {
  report::PlotLine points{.name = "cases", .points_only = true};
  for (const CaseResult& one : results.cases) {
    const RegionResult* const found = region_of_case(one, region.region);
    if (found == nullptr) continue;
    points.x.push_back(0.5 * (found->predicted_y_mm + found->achieved_y_mm));
    points.y.push_back(found->predicted_y_mm - found->achieved_y_mm);
  }
  const auto [low, high] = std::minmax_element(points.x.begin(), points.x.end());
  const auto level = [&, left = *low, right = *high](const char* name, double y) {
    return report::PlotLine{.name = name, .x = {left, right}, .y = {y, y}};
  };
  const compare::Agreement& agreement = region.agreement_y;
  return {
      .title = fmt::format("Agreement of predicted and achieved displacement: {}", region.region),
      .x_label = "mean of predicted and achieved displacement along y [mm]",
      .y_label = "predicted - achieved [mm]",
      .lines = {points, level("bias", agreement.bias),
                level("limits of agreement", agreement.limits.low),
                level("limits of agreement", agreement.limits.high)}};
}

std::vector<report::KeyNumber> key_numbers(const CohortResults& results) {
  const std::size_t failed = failures_of(results);
  std::vector<report::KeyNumber> numbers{
      {"cases compared",
       fmt::format("{} of {}", results.cases.size() - failed, results.cases.size())}};
  for (const CohortRegion& region : results.regions) {
    if (region.region != "face" && region.region != "lower face") continue;
    for (std::size_t m = 0; m < kMethods.size(); ++m)
      numbers.push_back({fmt::format("{}: mean error, {}", region.region, kMethodNames[m]),
                         in_words(region.methods[m][0], 2) + " mm"});
  }
  return numbers;
}

}  // namespace

Json value_json(const CohortValue& value) {
  return {{"mean", finite_or_null(value.mean)},
          {"low", finite_or_null(value.interval.low)},
          {"high", finite_or_null(value.interval.high)}};
}

Json region_json(const CohortRegion& region) {
  Json json{{"region", region.region}, {"cases", region.cases}};
  for (std::size_t m = 0; m < kMethods.size(); ++m)
    for (std::size_t s = 0; s < kStatistics.size(); ++s)
      json["methods"][kMethods[m]][kStatistics[s]] = value_json(region.methods[m][s]);
  for (std::size_t m = 1; m < kMethods.size(); ++m)
    json["gain_mm"][kMethods[m]] = value_json(region.gain_mm[m]);
  json["cases_within_1mm_fraction"] = region.cases_within_1mm_fraction;
  json["cases_within_2mm_fraction"] = region.cases_within_2mm_fraction;
  const compare::Agreement& agreement = region.agreement_y;
  json["agreement_y"] = {{"pairs", agreement.pairs},
                         {"bias_mm", finite_or_null(agreement.bias)},
                         {"standard_deviation_mm", finite_or_null(agreement.standard_deviation)},
                         {"lower_limit_mm", finite_or_null(agreement.limits.low)},
                         {"upper_limit_mm", finite_or_null(agreement.limits.high)}};
  return json;
}

std::string in_words(const CohortValue& value, int digits) {
  if (!std::isfinite(value.mean)) return "-";
  if (!std::isfinite(value.interval.low)) return fixed(value.mean, digits);
  return fmt::format("{} [{}, {}]", fixed(value.mean, digits), fixed(value.interval.low, digits),
                     fixed(value.interval.high, digits));
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

Json cohort_json(const CohortResults& results, const ValidateJob& job) {
  const std::size_t failed = failures_of(results);
  Json json{{"lefort_validation", 1},
            {"notice", kNotForClinicalUse},
            {"version", kVersion},
            {"options",
             {{"movements", job.achieved_movements ? "achieved" : "planned"},
              {"element_size_mm", job.element_size_mm ? Json(*job.element_size_mm) : Json()},
              {"voxel_mm", job.voxel_mm}}},
            {"bootstrap",
             {{"replicates", results.bootstrap.replicates},
              {"level", results.bootstrap.level},
              {"seed", results.bootstrap.seed}}},
            {"cases_total", results.cases.size()},
            {"cases_compared", results.cases.size() - failed},
            {"cases_failed", failed}};
  json["failures"] = json["regions"] = json["cases"] = Json::array();
  for (const CaseResult& one : results.cases)
    if (one.failure) json["failures"].push_back({{"case", one.name}, {"reason", *one.failure}});
  for (const CohortRegion& region : results.regions) json["regions"].push_back(region_json(region));
  for (const CaseResult& one : results.cases) {
    json["cases"].push_back(as_json(one));
    json["cases"].back().erase("lefort_validation_case");
  }
  return json;
}

std::string cohort_csv(const CohortResults& results) {
  std::string csv = "case,region,method,area_mm2,compared_fraction";
  for (const char* statistic : kStatistics) csv += fmt::format(",{}", statistic);
  csv += ",achieved_y_mm,predicted_y_mm,failure\n";
  const auto cell = [](double value) {
    return std::isfinite(value) ? fmt::format(",{:.4f}", value) : std::string(",");
  };
  for (const CaseResult& one : results.cases) {
    if (one.failure)
      csv += csv_field(one.name) + std::string(6 + kStatistics.size(), ',') + "," +
             csv_field(*one.failure) + "\n";
    for (const RegionResult& region : one.regions)
      for (std::size_t m = 0; m < kMethods.size(); ++m) {
        csv += fmt::format("{},{},{},{:.1f},{:.4f}", csv_field(one.name), region.region,
                           kMethods[m], region.area_mm2, region.compared_fraction);
        for (const double value : region.methods[m]) csv += cell(value);
        csv += cell(region.achieved_y_mm) + cell(m == 0 ? region.predicted_y_mm : NAN) + ",\n";
      }
  }
  return csv;
}

report::CaseReport cohort_report(const CohortResults& results,
                                 std::vector<report::ReportPicture> pictures) {
  const std::size_t failed = failures_of(results);
  report::CaseReport report;
  report.title = fmt::format("Validation on {} cases", results.cases.size());
  report.subtitle = "Predicted faces beside achieved faces";
  report.plan =
      fmt::format("{} cases were compared, {} failed.", results.cases.size() - failed, failed);
  report.converged = true;
  report.pictures = std::move(pictures);
  report.pictures_heading = "Difference of each case";
  report.key_numbers = key_numbers(results);
  report.tables = {methods_table(results)};
  for (std::size_t m = 0; m < kMethods.size(); ++m)
    report.tables.push_back(statistics_table(results, m));
  report.tables.push_back(success_table(results));
  report.tables.push_back(cases_table(results));
  if (failed > 0) report.tables.push_back(failures_table(results));
  report.plots_heading = "Agreement (Bland and Altman 1986)";
  for (const CohortRegion& region : results.regions)
    if (region.cases >= 2) report.plots.push_back(agreement_plot(results, region));
  report.notes = {
      "Distances are from the predicted skin to the closest point of the achieved skin. Signed "
      "means "
      "are prediction minus achieved: x to the patient's left, y posterior, z superior.",
      "No change: the skin before surgery instead of the prediction. Ratio rule: skin moves by a "
      "published fraction of the closest bone's movement (docs/guide/validate.md).",
      fmt::format("Intervals: percentile bootstrap over cases, {} replicates, seed {} (Efron and "
                  "Tibshirani 1993). A cohort of fewer than about ten cases has unreliable "
                  "intervals.",
                  results.bootstrap.replicates, results.bootstrap.seed),
      "Cases that failed have no distances; they count as not within any limit."};
  report.limitations = {
      "The closest point need not be the same point of the skin: movement of the skin along itself "
      "is not measured. Swelling, weight change and facial expression are part of the error."};
  return report;
}

std::string cohort_text(const CohortResults& results) {
  const std::size_t failed = failures_of(results);
  std::string text = fmt::format("{} of {} cases compared\n  {:<14} {:>22} {:>22} {:>22}",
                                 results.cases.size() - failed, results.cases.size(),
                                 "mean error [mm]", "prediction", "no change", "ratio rule");
  for (const CohortRegion& region : results.regions)
    text += fmt::format("\n  {:<15} {:>22} {:>22} {:>22}", region.region,
                        in_words(region.methods[0][0], 2), in_words(region.methods[1][0], 2),
                        in_words(region.methods[2][0], 2));
  for (const CaseResult& one : results.cases)
    if (one.failure) text += fmt::format("\n  failed: {}: {}", one.name, *one.failure);
  return text;
}

}  // namespace lefort::pipeline
