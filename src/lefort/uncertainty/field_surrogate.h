/// \file
/// Surrogate of a field: its modes, and a polynomial chaos of the score of each mode.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/uncertainty/chaos_basis.h>
#include <lefort/uncertainty/field_modes.h>
#include <lefort/uncertainty/fit_chaos.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::uncertainty {

/// value(v) = mean[v] + sum over modes k and terms t of modes(v, k) coefficients(t, k) Psi_t(x).
struct FieldSurrogate {
  ChaosBasis basis;
  VectorX mean;                  ///< One per point.
  Eigen::MatrixXd modes;         ///< Points by modes.
  Eigen::MatrixXd coefficients;  ///< Terms by modes; zero for terms that were not selected.
};

/// A surrogate with what is needed to judge it.
struct FittedField {
  FieldSurrogate surrogate;
  FieldModes modes;              ///< Of the samples.
  Eigen::MatrixXd basis_values;  ///< Terms (columns) at the samples.
  std::vector<ChaosFit> fits;    ///< One per mode.
  Eigen::MatrixXd cv_errors;     ///< Cross-validated errors of the scores: samples by modes.
};

struct FieldFitOptions {
  double variance_fraction = 0.999;  ///< See find_modes().
  BasisOptions basis{};
  Index folds = 10;  ///< See cross_validate().
};

/// \param inputs   of the model.
/// \param points   one row per sample, in the units of the inputs.
/// \param samples  the fields; three or more.
/// \param weights  see find_modes().
/// \returns the surrogate, or kCancelled.
[[nodiscard]] Result<FittedField> fit_field(const std::vector<ChaosInput>& inputs,
                                            const Eigen::MatrixXd& points,
                                            std::span<const std::vector<float>> samples,
                                            std::span<const double> weights,
                                            const FieldFitOptions& options,
                                            Progress& progress = Progress::none());

/// The sum of two surrogates with the same inputs, for example of a coarse model and of its
/// correction.
[[nodiscard]] FieldSurrogate add(const FieldSurrogate& a, const FieldSurrogate& b);

/// Scores at points of the inputs, one row per point, one column per mode.
[[nodiscard]] Eigen::MatrixXd scores_at(const FieldSurrogate& surrogate,
                                        const Eigen::MatrixXd& points);

/// Quantiles and deviation at each point of the field.
struct FieldBand {
  std::vector<std::vector<double>> quantiles;  ///< One list per probability, one entry per point.
  std::vector<double> standard_deviation;      ///< From the coefficients, not from samples.
};

/// \param probabilities  of the quantiles, of (0, 1).
/// \param scores         of scores_at() at points drawn from the distributions of the inputs.
/// \returns the band, or kCancelled.
[[nodiscard]] Result<FieldBand> field_band(const FieldSurrogate& surrogate,
                                           const Eigen::MatrixXd& scores,
                                           std::span<const double> probabilities,
                                           Progress& progress = Progress::none());

/// Quantile of numbers: linear between order statistics (type 7 of Hyndman and Fan).
///
/// \param values       not empty; they are partly sorted.
/// \param probability  0 to 1.
[[nodiscard]] double sample_quantile(std::span<double> values, double probability);

}  // namespace lefort::uncertainty
