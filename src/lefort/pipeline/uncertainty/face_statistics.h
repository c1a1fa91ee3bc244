/// \file
/// Statistics of a face with uncertain inputs, from its solved samples.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/uncertainty/uncertain_case.h>
#include <lefort/uncertainty/field_surrogate.h>
#include <lefort/uncertainty/sobol_indices.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// A part of the skin. Weights are areas of vertices that belong to it, 0 elsewhere.
struct SkinRegion {
  std::string name;  ///< "moved skin", "nose", ...
  std::vector<double> weights;
};

/// Results of one region; widths and deviations are means over its area.
struct RegionStatistics {
  std::string name{};
  double area_mm2 = 0.0;
  double band_mm = 0.0;      ///< P95 - P5.
  double max_band_mm = 0.0;  ///< Of a vertex.
  double deviation_mm = 0.0;
  double q2 = 0.0;                        ///< Cross-validated, of the coarse surrogate.
  uncertainty::SobolIndices inputs{};     ///< Of each input, with the correction.
  uncertainty::SobolInterval interval{};  ///< Bootstrap of coarse surrogate and correction.
  uncertainty::SobolIndices groups{};     ///< Of each group of inputs.
};

/// The estimate from the first n samples.
struct ConvergenceRow {
  Index samples = 0;
  double band_mm = 0.0;                ///< Mean of the moved skin.
  double low_mm = 0.0, high_mm = 0.0;  ///< Bootstrap interval, kIntervalLevel, as of the indices.
  double q2 = 0.0;
};

/// The correction of the coarse model by the fine one: fine = coarse + correction, and the
/// correction has a surrogate of its own from few samples \cite ng2012 (the additive form of \cite
/// kennedy2000).
struct CorrectionStatistics {
  Index samples = 0;
  double mean_mm = 0.0;         ///< Mean of the absolute mean correction, over the moved skin.
  double deviation_mm = 0.0;    ///< Of the correction by the inputs, root mean square.
  double cv_error_mm = 0.0;     ///< Cross-validated error of the correction, root mean square.
  double correlation = 0.0;     ///< Of fine and coarse deviations from their means.
  double band_change_mm = 0.0;  ///< Mean band width with minus without the correction.
};

struct FaceStatistics {
  Index solved = 0;
  std::vector<SkinRegion> regions;
  std::vector<std::string> groups;  ///< Of inputs.
  uncertainty::FittedField coarse;
  std::optional<uncertainty::FittedField> correction;
  uncertainty::FieldSurrogate total;
  uncertainty::FieldBand band;  ///< P5, P50, P95 along the normal, at the sampled vertices.
  std::vector<RegionStatistics> region_results;
  std::vector<ConvergenceRow> convergence;
  std::optional<CorrectionStatistics> correction_results;
  double band_mm = 0.0;  ///< Mean over the moved skin.
};

inline constexpr std::array kBandProbabilities{0.05, 0.50, 0.95};
inline constexpr int kSurrogateDraws = 4000;
/// Of the bootstrap of Sobol indices. Its seed, that of the correction and that of the draws of the
/// surrogate follow from UncertaintyJob::seed.
inline constexpr int kReplicates = 200;
inline constexpr int kBandReplicates = 40;  ///< Of the bootstrap of the band.
inline constexpr double kIntervalLevel = 0.9;

/// \param face     its inputs, design and skin.
/// \param regions  the first is the moved skin.
/// \param coarse   all samples; failed ones are left out.
/// \param fine     a subset of their numbers.
/// \returns the statistics; kNotConverged if fewer than 20 samples were solved, or kCancelled.
[[nodiscard]] Result<FaceStatistics> face_statistics(const UncertainCase& face,
                                                     std::vector<SkinRegion> regions,
                                                     const SolvedSamples& coarse,
                                                     const SolvedSamples& fine, std::uint64_t seed,
                                                     Progress& progress);

/// Estimated memory of the statistics, 1e9 bytes: the samples and their copy without failed ones,
/// the inner products of all pairs of samples with their eigenvectors, the values of the terms.
[[nodiscard]] double statistics_memory_gb(std::size_t samples, std::size_t vertices);

/// \param machine_gb  memory of the machine.
/// \returns nothing, or kOutOfMemory if the statistics need more than the machine has.
[[nodiscard]] Result<void> check_statistics_memory(std::size_t samples, std::size_t vertices,
                                                   double machine_gb);

/// The moved skin, then the regions of the face (compare/face_regions.h) by the landmarks of the
/// plan, or by landmarks that are found in the scan. Without landmarks only the moved skin.
[[nodiscard]] std::vector<SkinRegion> skin_regions(const UncertainCase& face, Progress& progress);

}  // namespace lefort::pipeline
