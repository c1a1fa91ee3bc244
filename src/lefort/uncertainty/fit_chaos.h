/// \file
/// Polynomial chaos of one output by least squares.
#pragma once

#include <lefort/core/types.h>

#include <span>
#include <vector>

namespace lefort::uncertainty {

/// A sparse polynomial chaos.
struct ChaosFit {
  std::vector<Index> terms;  ///< Numbers of the terms; the first is the constant, 0.
  VectorX coefficients;      ///< One for each of `terms`.
  Index candidate = 0;       ///< Number of the candidate set.
  /// 1 minus the corrected leave-one-out error over the variance; 1 is exact. It is also the
  /// criterion of the selection, and therefore slightly too high: see cross_validate().
  double q2 = 0.0;
};

/// Selects terms one by one: each time that which reduces the residual most, by orthogonal least
/// squares \cite chen1989. The number of terms and the candidate set are those with the smallest
/// leave-one-out error, which follows from the fit to all points (\cite blatman2011):
///
///     err = T / N sum_i (r_i / (1 - h_i))^2,   T = N / (N - P) (1 + tr(C^-1) / N),   C = A^T A / N
///
/// with the residuals r_i, the diagonal h_i of the projection on the P terms, and the correction T
/// for small samples \cite chapelle2002.
///
/// \param basis           values of the terms (columns) at the points (rows); the first is 1.
/// \param candidate_ends  see ChaosBasis.
/// \param values          of the output, one per point; three or more.
/// \returns the fit. The constant alone if no term reduces the error.
[[nodiscard]] ChaosFit fit_chaos(const Eigen::MatrixXd& basis,
                                 std::span<const Index> candidate_ends, const VectorX& values);

/// Coefficients of given terms by least squares over drawn points: a replicate of the bootstrap
/// with fixed terms \cite marelli2018.
///
/// \param fit    its terms are used.
/// \param drawn  numbers of points, with repetitions.
[[nodiscard]] VectorX refit(const Eigen::MatrixXd& basis, const ChaosFit& fit,
                            const VectorX& values, std::span<const Index> drawn);

/// Errors at points that took no part in the fit and in the selection of its terms: the points are
/// divided into `folds` sets, point i into set i mod folds.
///
/// \param candidate  of the fit to all points: the folds use this candidate set.
/// \param folds      2 or more, at most the number of points.
/// \returns prediction minus value, one per point.
[[nodiscard]] VectorX cross_validate(const Eigen::MatrixXd& basis,
                                     std::span<const Index> candidate_ends, Index candidate,
                                     const VectorX& values, Index folds);

}  // namespace lefort::uncertainty
