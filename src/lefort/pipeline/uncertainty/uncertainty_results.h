/// \file
/// Results of uncertain inputs as values, JSON, table, pictures and report.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/uncertainty/face_statistics.h>
#include <lefort/pipeline/uncertainty/uncertain_case.h>
#include <lefort/report/case_report.h>

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// The check of the warm start: samples solved from the nominal equilibrium and along the whole
/// path.
struct PathCheck {
  Index samples = 0;
  double mean_mm = 0.0;  ///< Distance along the normal, over the moved skin.
  double max_mm = 0.0;
};

/// A larger fraction of failed samples is reported as a bias.
inline constexpr double kMaxFailedFraction = 0.05;

/// Everything that is written.
struct UncertaintyResults {
  SolvedSamples coarse, fine;
  FaceStatistics statistics;
  std::optional<PathCheck> path_check;
  std::size_t models = 0;  ///< Of different levels.
  std::uint64_t seed = 0;

  [[nodiscard]] std::size_t failed() const;
  /// More than kMaxFailedFraction of the samples have no result: that of the others is biased.
  [[nodiscard]] bool is_biased() const;
};

/// Displacement of each vertex of the skin [mm]: the nominal one of the coarse model, moved along
/// its normal to the median.
[[nodiscard]] std::vector<Vec3> median_skin_mm(const UncertainCase& face,
                                               const FaceStatistics& statistics);

/// A value per sampled vertex as one per vertex of the skin; others have `elsewhere`.
[[nodiscard]] std::vector<double> on_skin(const UncertainCase& face,
                                          const std::vector<double>& values, double elsewhere);

/// contract/uncertainty.schema.json.
[[nodiscard]] nlohmann::ordered_json uncertainty_json(const UncertainCase& face,
                                                      const UncertaintyResults& results);

/// One line per sample: inputs, status, mean displacement along the normal in each region.
[[nodiscard]] std::string samples_csv(const UncertainCase& face, const UncertaintyResults& results);

/// Profile in the sagittal plane through the most anterior point of the face.
[[nodiscard]] report::BandPlot profile_plot(const UncertainCase& face,
                                            const FaceStatistics& statistics);

struct UncertaintyPicture {
  std::string file;
  std::string title;
  std::string png;
};

/// The band width on the median face, from the front and from the right.
[[nodiscard]] Result<std::vector<UncertaintyPicture>> draw_uncertainty(
    const UncertainCase& face, const FaceStatistics& statistics, Progress& progress);

[[nodiscard]] report::CaseReport uncertainty_report(
    const UncertainCase& face, const UncertaintyResults& results,
    const std::vector<UncertaintyPicture>& pictures);

}  // namespace lefort::pipeline
