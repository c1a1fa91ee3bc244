/// \file
/// Sobol indices from the coefficients of a polynomial chaos.
#pragma once

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

/// Percentile interval of a bootstrap.
struct SobolInterval {
  std::vector<double> first_low, first_high, total_low, total_high;
};

/// Bootstrap intervals: samples are drawn with replacement, the coefficients of the selected terms
/// fitted again \cite marelli2018, the indices computed again.
///
/// \param fitted      the surrogate; without the correction by a finer model.
/// \param gram        of the region.
/// \param replicates  number of draws, >= 20.
/// \param level       of the interval, 0 to 1.
/// \param seed        the same seed gives the same bits.
[[nodiscard]] SobolInterval sobol_bootstrap(const FittedField& fitted, const Eigen::MatrixXd& gram,
                                            std::span<const std::vector<Index>> groups,
                                            int replicates, double level, std::uint64_t seed);

/// The surrogate with coefficients fitted to samples drawn with replacement.
[[nodiscard]] FieldSurrogate draw_surrogate(const FittedField& fitted,
                                            std::span<const Index> drawn);

/// Draws `count` of `count` numbers with replacement, `replicates` times.
[[nodiscard]] std::vector<std::vector<Index>> draw_samples(Index count, int replicates,
                                                           std::uint64_t seed);

}  // namespace lefort::uncertainty
