/// \file
/// Products of orthonormal polynomials of independent inputs: the basis of polynomial chaos
/// \cite xiu2002.
#pragma once

#include <lefort/core/types.h>
#include <lefort/uncertainty/distribution.h>

#include <span>
#include <vector>

namespace lefort::uncertainty {

/// An uncertain input of a model.
struct ChaosInput {
  Distribution distribution;
  int max_degree = 20;  ///< Of its polynomials, >= 1; less than its number of levels.
};

/// Degree of the polynomial of each input.
using ChaosTerm = std::vector<int>;

/// Terms in the order in which a fit may use them.
struct ChaosBasis {
  std::vector<ChaosInput> inputs;
  std::vector<ChaosTerm> terms;       ///< The first is the constant.
  std::vector<Index> candidate_ends;  ///< Candidate sets: the first n terms; ascending.
};

struct BasisOptions {
  int max_degree = 10;  ///< Total degree.
  /// Terms of the largest candidate set; a set that would be larger is left out.
  Index max_terms = 600;
};

/// Candidate sets of total degree 1, 2, 3, ...: for each degree p > 1 first the hyperbolic set,
/// whose terms satisfy (sum a_j^q)^(1/q) <= p with q = 0.75 \cite blatman2011, then the full set (q
/// = 1). A set contains those before it.
///
/// \param inputs  one or more.
[[nodiscard]] ChaosBasis make_basis(std::vector<ChaosInput> inputs, const BasisOptions& options);

/// \param points  one row per point, one column per input.
/// \returns the value of each term (columns) at each point.
[[nodiscard]] Eigen::MatrixXd evaluate(const ChaosBasis& basis, const Eigen::MatrixXd& points);

/// Points of the inputs from probabilities.
///
/// \param probabilities  of (0, 1): one row per point, one column per distribution.
[[nodiscard]] Eigen::MatrixXd points_at(std::span<const Distribution> distributions,
                                        const Eigen::MatrixXd& probabilities);

}  // namespace lefort::uncertainty
