#include <lefort/pipeline/validate/cohort_statistics.h>

#include <cmath>
#include <limits>

namespace lefort::pipeline {
namespace {

constexpr std::size_t kMean = 0;  // Position of the mean in kStatistics.

/// Mean of the chosen values without NaN.
double mean_of(std::span<const double> values, std::span<const Index> chosen) {
  double sum = 0.0;
  Index count = 0;
  for (const Index k : chosen) {
    const double value = values[std::size_t(k)];
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / double(count);
}

std::vector<const RegionResult*> find_region(std::span<const CaseResult> results,
                                             const std::string& name) {
  std::vector<const RegionResult*> found;
  for (const CaseResult& result : results)
    for (const RegionResult& region : result.regions)
      if (region.region == name && !std::isnan(region.methods[0][kMean])) found.push_back(&region);
  return found;
}

double fraction_within(const std::vector<const RegionResult*>& rows, std::size_t cases,
                       double limit_mm) {
  std::size_t within = 0;
  for (const RegionResult* row : rows)
    if (row->methods[0][kMean] <= limit_mm) ++within;
  return double(within) / double(cases);
}

CohortRegion region_statistics(const std::string& name,
                               const std::vector<const RegionResult*>& rows, std::size_t cases,
                               const compare::BootstrapOptions& bootstrap) {
  CohortRegion region;
  region.region = name;
  region.cases = Index(rows.size());
  const auto values = [&](auto of) {
    std::vector<double> list;
    for (const RegionResult* row : rows) list.push_back(of(*row));
    return list;
  };
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    for (std::size_t s = 0; s < kStatistics.size(); ++s)
      region.methods[m][s] = cohort_value(
          values([&](const RegionResult& row) { return row.methods[m][s]; }), bootstrap);
    region.gain_mm[m] = cohort_value(values([&](const RegionResult& row) {
                                       return row.methods[m][kMean] - row.methods[0][kMean];
                                     }),
                                     bootstrap);
  }
  region.cases_within_1mm_fraction = fraction_within(rows, cases, 1.0);
  region.cases_within_2mm_fraction = fraction_within(rows, cases, 2.0);
  region.agreement_y =
      compare::agreement_of(values([](const RegionResult& row) { return row.predicted_y_mm; }),
                            values([](const RegionResult& row) { return row.achieved_y_mm; }));
  return region;
}

}  // namespace

CohortValue cohort_value(std::span<const double> values,
                         const compare::BootstrapOptions& bootstrap) {
  std::vector<Index> all;
  for (std::size_t k = 0; k < values.size(); ++k) all.push_back(Index(k));
  return {mean_of(values, all),
          compare::bootstrap_interval(
              Index(values.size()),
              [&](std::span<const Index> chosen) { return mean_of(values, chosen); }, bootstrap)};
}

std::vector<CohortRegion> cohort_statistics(std::span<const CaseResult> results,
                                            const compare::BootstrapOptions& bootstrap) {
  std::vector<CohortRegion> regions;
  for (const compare::ReportedRegion& reported : compare::reported_regions()) {
    const auto rows = find_region(results, reported.name);
    if (!rows.empty())
      regions.push_back(region_statistics(reported.name, rows, results.size(), bootstrap));
  }
  return regions;
}

}  // namespace lefort::pipeline
