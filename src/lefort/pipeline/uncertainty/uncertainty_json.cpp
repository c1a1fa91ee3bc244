#include <lefort/core/version.h>
#include <lefort/pipeline/uncertainty/inputs_json.h>
#include <lefort/pipeline/uncertainty/uncertainty_results.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json finite_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json input_json(const UncertainInput& input) {
  const uncertainty::Moments moments = uncertainty::moments_of(input.distribution);
  Json json{{"name", input.name},
            {"parameter", input.parameter->name},
            {"meaning", input.parameter->meaning},
            {"unit", input.parameter->unit},
            {"group", input.parameter->group},
            {"distribution", pipeline::as_json(input.distribution)},
            {"mean", moments.mean},
            {"standard_deviation", std::sqrt(moments.variance)},
            {"source", input.source}};
  json["levels"] = input.is_in_levels() ? pipeline::as_json(input.sampled) : Json(nullptr);
  return json;
}

Json indices_json(const std::vector<std::string>& names, const uncertainty::SobolIndices& indices,
                  const uncertainty::SobolInterval* interval) {
  Json list = Json::array();
  for (std::size_t n = 0; n < names.size(); ++n) {
    Json one{{"name", names[n]}, {"first", indices.first[n]}, {"total", indices.total[n]}};
    if (interval != nullptr) {
      one["first_interval"] = {interval->first_low[n], interval->first_high[n]};
      one["total_interval"] = {interval->total_low[n], interval->total_high[n]};
    }
    list.push_back(std::move(one));
  }
  return list;
}

Json provenance_json(const UncertainCase& face) {
  const Provenance& provenance = face.prepared().provenance;
  Json files = Json::array();
  for (const io::InputFile& file : provenance.plan_files)
    files.push_back({{"file", file.name}, {"sha256", file.sha256}});
  return {{"plan_sha256", provenance.plan_sha256},
          {"plan_files", std::move(files)},
          {"ct_sha256", provenance.ct_sha256},
          {"ct_file_sha256", face.ct_file_sha256() ? Json(*face.ct_file_sha256()) : Json(nullptr)}};
}

std::vector<std::string> names_of(const UncertainCase& face) {
  std::vector<std::string> names;
  for (const UncertainInput& input : face.inputs().inputs) names.push_back(input.name);
  return names;
}

Json region_json(const RegionStatistics& region, const std::vector<std::string>& inputs,
                 const std::vector<std::string>& groups) {
  return {{"region", region.name},
          {"area_mm2", region.area_mm2},
          {"mean_band_mm", region.band_mm},
          {"max_band_mm", region.max_band_mm},
          {"mean_standard_deviation_mm", region.deviation_mm},
          {"q2", finite_number(region.q2)},
          {"sobol", indices_json(inputs, region.inputs, &region.interval)},
          {"sobol_groups", indices_json(groups, region.groups, nullptr)}};
}

Json surrogate_json(const FaceStatistics& statistics) {
  const uncertainty::FittedField& coarse = statistics.coarse;
  Json modes = Json::array();
  for (std::size_t k = 0; k < coarse.fits.size(); ++k)
    modes.push_back({{"q2_leave_one_out", finite_number(coarse.fits[k].q2)},
                     {"terms", coarse.fits[k].terms.size()},
                     {"candidate_set", coarse.fits[k].candidate}});
  return {{"kind", "polynomial chaos"},
          {"terms", coarse.surrogate.basis.terms.size()},
          {"modes", std::move(modes)},
          {"kept_variance_fraction", coarse.modes.kept},
          {"truncation_rms_mm", coarse.modes.rms_error},
          {"truncation_max_mm", coarse.modes.max_error}};
}

Json correction_json(const FaceStatistics& statistics) {
  if (!statistics.correction_results) return nullptr;
  const CorrectionStatistics& found = *statistics.correction_results;
  return {{"samples", found.samples},
          {"mean_absolute_mm", found.mean_mm},
          {"rms_by_inputs_mm", found.deviation_mm},
          {"cross_validated_rms_error_mm", found.cv_error_mm},
          {"correlation", found.correlation},
          {"mean_band_change_mm", found.band_change_mm}};
}

Json convergence_json(const std::vector<ConvergenceRow>& rows) {
  Json list = Json::array();
  for (const ConvergenceRow& row : rows)
    list.push_back({{"samples", row.samples},
                    {"mean_band_mm", row.band_mm},
                    {"interval_mm", {row.low_mm, row.high_mm}},
                    {"q2", finite_number(row.q2)}});
  return list;
}

Json failures_json(const SolvedSamples& samples) {
  Json list = Json::array();
  for (std::size_t k = 0; k < samples.numbers.size(); ++k)
    if (!samples.results[k].is_solved())
      list.push_back({{"sample", samples.numbers[k]}, {"reason", samples.results[k].failure}});
  return list;
}

Json samples_json(const UncertainCase& face, const SolvedSamples& samples) {
  Json list = Json::array();
  for (std::size_t k = 0; k < samples.numbers.size(); ++k) {
    const VectorX row = face.points().row(samples.numbers[k]);
    list.push_back({{"sample", samples.numbers[k]},
                    {"solved", samples.results[k].is_solved()},
                    {"from_rest", samples.results[k].is_from_rest},
                    {"newton_iterations", samples.results[k].newton_iterations},
                    {"values", std::vector<double>(row.data(), row.data() + row.size())}});
  }
  return list;
}

/// A field of RFC 4180 in quotes.
std::string quoted(const std::string& text) {
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

}  // namespace

std::size_t UncertaintyResults::failed() const {
  return std::size_t(std::count_if(coarse.results.begin(), coarse.results.end(),
                                   [](const SampleResult& one) { return !one.is_solved(); }));
}

bool UncertaintyResults::is_biased() const {
  return double(failed()) > kMaxFailedFraction * double(coarse.results.size());
}

Json uncertainty_json(const UncertainCase& face, const UncertaintyResults& results) {
  const FaceStatistics& statistics = results.statistics;
  Json inputs = Json::array();
  for (const UncertainInput& input : face.inputs().inputs) inputs.push_back(input_json(input));
  Json regions = Json::array();
  for (const RegionStatistics& region : statistics.region_results)
    regions.push_back(region_json(region, names_of(face), statistics.groups));
  Json json{{"lefort_uncertainty", 1},
            {"notice", kNotForClinicalUse},
            {"version", kVersion},
            {"provenance", provenance_json(face)},
            {"seed", results.seed},
            {"design", "nested Latin hypercube"},
            {"inputs", std::move(inputs)},
            {"inputs_without_effect", face.inputs().without_effect},
            {"element_size_mm",
             {{"coarse", face.middle().options.tissue.element_size_mm},
              {"fine", face.prepared().plan.tissue.element_size_mm}}},
            {"relative_tolerance", face.middle().options.solver.relative_tolerance},
            {"models", results.models},
            {"samples",
             {{"count", results.coarse.results.size()},
              {"failed", results.failed()},
              {"biased", results.is_biased()},
              {"failures", failures_json(results.coarse)},
              {"fine", results.fine.results.size()},
              {"fine_failures", failures_json(results.fine)}}},
            {"mean_band_mm", statistics.band_mm},
            {"surrogate", surrogate_json(statistics)},
            {"correction", correction_json(statistics)},
            {"regions", std::move(regions)},
            {"interval_level", kIntervalLevel},
            {"convergence", convergence_json(statistics.convergence)}};
  json["path_check"] = results.path_check
                           ? Json{{"samples", results.path_check->samples},
                                  {"mean_difference_mm", results.path_check->mean_mm},
                                  {"max_difference_mm", results.path_check->max_mm}}
                           : Json(nullptr);
  json["sample_table"] = samples_json(face, results.coarse);
  return json;
}

std::string samples_csv(const UncertainCase& face, const UncertaintyResults& results) {
  std::string csv = "sample,status,start,newton_iterations,reason";
  for (const UncertainInput& input : face.inputs().inputs)
    csv += "," + quoted(*input.parameter->unit == '\0'
                            ? input.name
                            : fmt::format("{} [{}]", input.name, input.parameter->unit));
  for (const SkinRegion& region : results.statistics.regions)
    csv += "," + quoted(region.name + ": mean displacement along the normal [mm]");
  csv += "\n";
  for (std::size_t k = 0; k < results.coarse.numbers.size(); ++k) {
    const SampleResult& one = results.coarse.results[k];
    csv += fmt::format("{},{},{},{},{}", results.coarse.numbers[k],
                       one.is_solved() ? "solved" : "failed", one.is_from_rest ? "rest" : "nominal",
                       one.newton_iterations, quoted(one.failure));
    for (Index j = 0; j < face.points().cols(); ++j)
      csv += fmt::format(",{}", face.points()(results.coarse.numbers[k], j));
    for (const SkinRegion& region : results.statistics.regions) {
      double sum = 0.0, area = 0.0;
      for (std::size_t v = 0; one.is_solved() && v < region.weights.size(); ++v) {
        sum += region.weights[v] * double(one.normal_mm[v]);
        area += region.weights[v];
      }
      csv += area > 0.0 ? fmt::format(",{:.6f}", sum / area) : ",";
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace lefort::pipeline
