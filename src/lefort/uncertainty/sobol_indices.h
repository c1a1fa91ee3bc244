/// \file
/// Sobol indices from the coefficients of a polynomial chaos.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/uncertainty/chaos_basis.h>
#include <lefort/uncertainty/field_surrogate.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::uncertainty {

/// Fractions of the variance. Without variance all are 0.
struct SobolIndices {
  double variance = 0.0;
  std::vector<double> first;  ///< By each input, or each group of inputs, alone.
  std::vector<double> total;  ///< With its interactions with others.
};

/// Indices of groups of inputs: the variance of a sum of orthonormal terms is the sum of the
/// squares of their coefficients, and each term depends on known inputs \cite sudret2008. For a
/// field, the indices are those of the variance summed over the points of a region \cite
/// lamboni2011.
///
/// \param basis         its terms.
/// \param coefficients  terms by modes.
/// \param gram          inner products of the modes over the region, see gram_of(); 1 for a scalar.
/// \param groups        numbers of the inputs of each group; one group per input for indices of
///   inputs.
[[nodiscard]] SobolIndices sobol_indices(const ChaosBasis& basis,
                                         const Eigen::MatrixXd& coefficients,
                                         const Eigen::MatrixXd& gram,
                                         std::span<const std::vector<Index>> groups);

/// Weighted inner products of the modes over the points of a region; the weights have the sum 1, so
/// that the variance is the mean over the region.
///
/// \param weights  one per point of the field, >= 0.
[[nodiscard]] Eigen::MatrixXd gram_of(const Eigen::MatrixXd& modes,
                                      std::span<const double> weights);

/// Surrogates fitted to samples that were drawn with replacement.
struct SurrogateReplicates {
  ChaosBasis basis;
  std::vector<Eigen::MatrixXd> coefficients;  ///< Terms by modes, one matrix per replicate.
};

/// Replicates of a bootstrap: the samples are drawn with replacement, the coefficients of the
/// selected terms are fitted again \cite marelli2018. The samples of a correction are drawn
/// independently of those of the coarse model, so that the spread contains the errors of both.
///
/// \param coarse      the surrogate.
/// \param correction  of the same inputs, added as by add(); null: none. Modes without coefficients
///   stay without: the samples of a replicate decide no selection.
/// \param replicates  number of draws, >= 1.
/// \param seed        the same seed gives the same bits. Draws have as many distinct samples as a
///   mode has terms, or more.
/// \returns the replicates, with the terms and the modes of add(); or kCancelled.
[[nodiscard]] Result<SurrogateReplicates> draw_surrogates(const FittedField& coarse,
                                                          const FittedField* correction,
                                                          int replicates, std::uint64_t seed,
                                                          Progress& progress);

/// Percentile interval of a bootstrap.
struct SobolInterval {
  std::vector<double> first_low, first_high, total_low, total_high;
};

/// \param gram   of the region, for the modes of the replicates.
/// \param level  of the interval, 0 to 1.
[[nodiscard]] SobolInterval sobol_interval(const SurrogateReplicates& replicates,
                                           const Eigen::MatrixXd& gram,
                                           std::span<const std::vector<Index>> groups,
                                           double level);

}  // namespace lefort::uncertainty
