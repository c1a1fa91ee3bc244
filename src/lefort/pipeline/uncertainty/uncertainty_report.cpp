#include <lefort/core/version.h>
#include <lefort/pipeline/uncertainty/uncertainty_results.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lefort::pipeline {
namespace {

using report::ReportTable;

/// Inputs with the largest total index in the moved skin; others are drawn together.
std::vector<std::size_t> main_inputs(const RegionStatistics& moved) {
  constexpr std::size_t kShown = 7;
  std::vector<std::size_t> order(moved.inputs.total.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return moved.inputs.total[a] > moved.inputs.total[b];
  });
  order.resize(std::min(order.size(), kShown));
  return order;
}

report::BarPlot sobol_plot(const UncertainCase& face, const FaceStatistics& statistics) {
  report::BarPlot plot{.title = "Sobol indices of first order by region",
                       .x_label = "fraction of the variance by the input alone"};
  const std::vector<std::size_t> shown = main_inputs(statistics.region_results.front());
  for (const std::size_t n : shown) plot.series.push_back(face.inputs().inputs[n].name);
  plot.series.push_back("other inputs");
  plot.series.push_back("interactions");
  for (const RegionStatistics& region : statistics.region_results) {
    report::Bar bar{.name = region.name};
    double shown_sum = 0.0;
    for (const std::size_t n : shown) {
      bar.parts.push_back(region.inputs.first[n]);
      shown_sum += region.inputs.first[n];
    }
    const double all = std::accumulate(region.inputs.first.begin(), region.inputs.first.end(), 0.0);
    bar.parts.push_back(std::max(0.0, all - shown_sum));
    bar.parts.push_back(region.inputs.variance > 0.0 ? std::max(0.0, 1.0 - all) : 0.0);
    plot.bars.push_back(std::move(bar));
  }
  return plot;
}

report::LinePlot convergence_plot(const FaceStatistics& statistics) {
  report::PlotLine mean{.name = "mean band width of the moved skin"};
  report::PlotLine low{.name = "bootstrap interval of 90 %"}, high{.name = low.name};
  for (const ConvergenceRow& row : statistics.convergence) {
    for (report::PlotLine* line : {&mean, &low, &high}) line->x.push_back(double(row.samples));
    mean.y.push_back(row.band_mm);
    low.y.push_back(row.low_mm);
    high.y.push_back(row.high_mm);
  }
  return {.title = "Convergence of the band",
          .x_label = "samples",
          .y_label = "P95 - P5 [mm]",
          .lines = {mean, low, high}};
}

ReportTable region_table(const FaceStatistics& statistics) {
  ReportTable table{.title = "Band along the normal of the skin, P5 to P95",
                    .heads = {"region", "mean width [mm]", "max width [mm]",
                              "mean standard deviation [mm]", "Q2"}};
  for (const RegionStatistics& region : statistics.region_results)
    table.rows.push_back({region.name, fmt::format("{:.2f}", region.band_mm),
                          fmt::format("{:.2f}", region.max_band_mm),
                          fmt::format("{:.2f}", region.deviation_mm),
                          fmt::format("{:.3f}", region.q2)});
  return table;
}

ReportTable index_table(const UncertainCase& face, const FaceStatistics& statistics) {
  ReportTable table{
      .title = "Sobol indices, first / total, with the bootstrap interval of the total",
      .heads = {"input"}};
  for (const RegionStatistics& region : statistics.region_results)
    table.heads.push_back(region.name);
  for (std::size_t n = 0; n < face.inputs().inputs.size(); ++n) {
    std::vector<std::string> row{face.inputs().inputs[n].name};
    for (const RegionStatistics& region : statistics.region_results)
      row.push_back(fmt::format("{:.2f} / {:.2f} ({:.2f} to {:.2f})", region.inputs.first[n],
                                region.inputs.total[n], region.interval.total_low[n],
                                region.interval.total_high[n]));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string in_words(const uncertainty::Distribution& one) {
  using uncertainty::DistributionKind;
  switch (one.kind) {
    case DistributionKind::kUniform:
      return fmt::format("uniform, {:g} to {:g}", one.low, one.high);
    case DistributionKind::kTriangular:
      return fmt::format("triangular, {:g}, {:g}, {:g}", one.low, one.mode, one.high);
    case DistributionKind::kTruncatedNormal:
      return fmt::format("normal, mean {:g}, standard deviation {:g}, {:g} to {:g}", one.mean,
                         one.standard_deviation, one.low, one.high);
    case DistributionKind::kDiscrete:
      return fmt::format("discrete, {} values, {:g} to {:g}", one.values.size(), one.values.front(),
                         one.values.back());
    default:
      return fmt::format("{}, mean {:g}, standard deviation {:g}", name_of(one.kind), one.mean,
                         one.standard_deviation);
  }
}

ReportTable input_table(const UncertainCase& face) {
  ReportTable table{.title = "Inputs", .heads = {"input", "unit", "distribution", "source"}};
  for (const UncertainInput& input : face.inputs().inputs)
    table.rows.push_back({input.name, input.parameter->unit,
                          in_words(input.distribution) +
                              (input.is_in_levels() && input.distribution.values.empty()
                                   ? fmt::format("; {} levels", input.sampled.values.size())
                                   : std::string()),
                          input.source});
  return table;
}

ReportTable method_table(const UncertaintyResults& results) {
  const FaceStatistics& statistics = results.statistics;
  const uncertainty::FieldModes& modes = statistics.coarse.modes;
  ReportTable table{.title = "Method", .heads = {"quantity", "value"}};
  const auto add = [&](const char* name, std::string value) {
    table.rows.push_back({name, std::move(value)});
  };
  add("samples of the coarse model",
      fmt::format("{}, of which {} failed", results.coarse.results.size(), results.failed()));
  add("models of different levels", fmt::format("{}", results.models));
  add("modes of the skin", fmt::format("{}, truncation error {:.3f} mm RMS, {:.2f} mm at most",
                                       modes.modes.cols(), modes.rms_error, modes.max_error));
  add("terms of the polynomial chaos",
      fmt::format("{}", statistics.coarse.surrogate.basis.terms.size()));
  if (const auto& found = statistics.correction_results)
    add("correction by the plan\u2019s mesh",
        fmt::format(
            "{} samples; mean {:.2f} mm, by the inputs {:.2f} mm RMS, cross-validated error "
            "{:.2f} mm RMS; correlation {:.3f}; mean band width {:+.2f} mm",
            found->samples, found->mean_mm, found->deviation_mm, found->cv_error_mm,
            found->correlation, found->band_change_mm));
  else
    add("correction by the plan\u2019s mesh", "none");
  if (results.path_check)
    add("start at the nominal equilibrium instead of the whole path",
        fmt::format("{} samples: difference {:.3f} mm on average, {:.2f} mm at most",
                    results.path_check->samples, results.path_check->mean_mm,
                    results.path_check->max_mm));
  return table;
}

std::vector<std::string> notes_on(const UncertainCase& face, const UncertaintyResults& results) {
  std::vector<std::string> notes;
  if (results.is_biased())
    notes.push_back(fmt::format(
        "{} of {} samples have no result, more than {:g} %: the band leaves out what these inputs "
        "lead to, and is biased.",
        results.failed(), results.coarse.results.size(), 100.0 * kMaxFailedFraction));
  else if (results.failed() > 0)
    notes.push_back(
        fmt::format("{} of {} samples have no result; uncertainty.json has the reasons.",
                    results.failed(), results.coarse.results.size()));
  for (const std::string& why : face.inputs().without_effect)
    notes.push_back("Input without effect: " + why + ".");
  return notes;
}

}  // namespace

report::CaseReport uncertainty_report(const UncertainCase& face, const UncertaintyResults& results,
                                      const std::vector<UncertaintyPicture>& pictures) {
  const FaceStatistics& statistics = results.statistics;
  const RegionStatistics& moved = statistics.region_results.front();
  report::CaseReport report;
  const std::string& title = face.prepared().plan.title;
  report.title = title.empty() ? "Uncertainty of the predicted face" : title + ": uncertainty";
  report.subtitle = "Band of the predicted face by the uncertainty of named inputs";
  report.plan = fmt::format(
      "{} inputs, {} samples of a coarse model, {} of the plan\u2019s mesh. P5 to P95: nine of ten "
      "predictions lie within the band at a point, if the inputs have the stated distributions.",
      face.inputs().inputs.size(), results.coarse.results.size(), results.fine.results.size());
  report.converged = true;
  for (const UncertaintyPicture& picture : pictures)
    report.pictures.push_back({picture.title, "", picture.png});
  report.pictures_heading = "Width of the band";
  report.key_numbers = {
      {"mean band width of the moved skin", fmt::format("{:.1f} mm", moved.band_mm)},
      {"max band width", fmt::format("{:.1f} mm", moved.max_band_mm)},
      {"Q2 of the surrogate", fmt::format("{:.3f}", moved.q2)},
      {"samples without result", fmt::format("{}", results.failed())}};
  report.tables = {region_table(statistics), index_table(face, statistics), input_table(face),
                   method_table(results)};
  report.bands = {profile_plot(face, statistics)};
  report.bars = {sobol_plot(face, statistics)};
  report.plots = {convergence_plot(statistics)};
  report.notes = notes_on(face, results);
  report.provenance = {{"lefort version", kVersion},
                       {"SHA-256 of the plan", face.prepared().provenance.plan_sha256},
                       {"SHA-256 of the scan\u2019s voxels", face.prepared().provenance.ct_sha256},
                       {"seed", fmt::format("{}", results.seed)}};
  report.limitations = {
      "The band contains only the named inputs. It does not contain the error of the model: the "
      "kind "
      "of interface of tissue and bone, the material law, lips, muscle tone, swelling, growth, "
      "posture and weight.",
      "Inputs are independent. Where their distribution is assumed, the source says so.",
      "Inputs that change mesh or boundary conditions are computed at few levels; the surrogate "
      "interpolates between them. The correction by the plan\u2019s mesh was computed at their "
      "middle "
      "level.",
      "Predictions are not validated against postoperative scans; neither is the band."};
  return report;
}

}  // namespace lefort::pipeline
