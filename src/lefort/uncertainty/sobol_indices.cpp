#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/core/random_draws.h>
#include <lefort/uncertainty/sobol_indices.h>

#include <algorithm>
#include <random>

namespace lefort::uncertainty {
namespace {

struct Bounds {
  double low, high;
};

Bounds percentiles(std::vector<double> values, double level) {
  return {sample_quantile(values, 0.5 * (1.0 - level)),
          sample_quantile(values, 0.5 * (1.0 + level))};
}

/// Position of each term of the full basis in the one without unused terms.
std::vector<Index> rows_of(const FittedField& fitted) {
  std::vector<bool> is_used(std::size_t(fitted.basis_values.cols()), false);
  is_used[0] = true;
  for (const ChaosFit& fit : fitted.fits)
    for (std::size_t k = 0; k < fit.terms.size(); ++k)
      if (fit.coefficients[Index(k)] != 0.0) is_used[std::size_t(fit.terms[k])] = true;
  std::vector<Index> rows(is_used.size(), -1);
  Index next = 0;
  for (std::size_t t = 0; t < is_used.size(); ++t)
    if (is_used[t]) rows[t] = next++;
  return rows;
}

Eigen::MatrixXd draw_coefficients(const FittedField& fitted, std::span<const Index> rows,
                                  std::span<const Index> drawn) {
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(fitted.surrogate.coefficients.rows(),
                                                       fitted.surrogate.coefficients.cols());
  for (std::size_t k = 0; k < fitted.fits.size(); ++k) {
    const ChaosFit& fit = fitted.fits[k];
    const VectorX again = refit(fitted.basis_values, fit, fitted.modes.scores.col(Index(k)), drawn);
    for (std::size_t t = 0; t < fit.terms.size(); ++t)
      if (const Index row = rows[std::size_t(fit.terms[t])]; row >= 0)
        coefficients(row, Index(k)) = again[Index(t)];
  }
  return coefficients;
}

}  // namespace

SobolIndices sobol_indices(const ChaosBasis& basis, const Eigen::MatrixXd& coefficients,
                           const Eigen::MatrixXd& gram,
                           std::span<const std::vector<Index>> groups) {
  LEFORT_CHECK(coefficients.rows() == Index(basis.terms.size()) &&
               coefficients.cols() == gram.rows() && gram.rows() == gram.cols());
  SobolIndices indices{.variance = 0.0,
                       .first = std::vector<double>(groups.size(), 0.0),
                       .total = std::vector<double>(groups.size(), 0.0)};
  for (std::size_t t = 0; t < basis.terms.size(); ++t) {
    const ChaosTerm& term = basis.terms[t];
    const auto active = std::count_if(term.begin(), term.end(), [](int n) { return n > 0; });
    if (active == 0) continue;
    const double part =
        coefficients.row(Index(t)).dot(gram * coefficients.row(Index(t)).transpose());
    indices.variance += part;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto inside = std::count_if(groups[g].begin(), groups[g].end(),
                                        [&](Index input) { return term[std::size_t(input)] > 0; });
      if (inside > 0) indices.total[g] += part;
      if (inside == active) indices.first[g] += part;
    }
  }
  if (indices.variance > 0.0)
    for (std::size_t g = 0; g < groups.size(); ++g) {
      indices.first[g] /= indices.variance;
      indices.total[g] /= indices.variance;
    }
  return indices;
}

Eigen::MatrixXd gram_of(const Eigen::MatrixXd& modes, std::span<const double> weights) {
  LEFORT_CHECK(modes.rows() == Index(weights.size()));
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(modes.cols(), modes.cols());
  double total = 0.0;
  for (Index v = 0; v < modes.rows(); ++v) {
    const double weight = weights[std::size_t(v)];
    if (!(weight > 0.0)) continue;
    total += weight;
    gram.noalias() += weight * modes.row(v).transpose() * modes.row(v);
  }
  return total > 0.0 ? Eigen::MatrixXd(gram / total) : gram;
}

SobolInterval sobol_bootstrap(const FittedField& fitted, const Eigen::MatrixXd& gram,
                              std::span<const std::vector<Index>> groups, int replicates,
                              double level, std::uint64_t seed) {
  const std::vector<std::vector<Index>> draws =
      draw_samples(fitted.basis_values.rows(), replicates, seed);
  const std::vector<Index> rows = rows_of(fitted);
  std::vector<SobolIndices> found(draws.size());
  parallel_for(
      Index(draws.size()),
      [&](Index b) {
        found[std::size_t(b)] =
            sobol_indices(fitted.surrogate.basis,
                          draw_coefficients(fitted, rows, draws[std::size_t(b)]), gram, groups);
      },
      1);
  SobolInterval interval;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<double> first, total;
    for (const SobolIndices& one : found) {
      first.push_back(one.first[g]);
      total.push_back(one.total[g]);
    }
    const Bounds of_first = percentiles(first, level), of_total = percentiles(total, level);
    interval.first_low.push_back(of_first.low);
    interval.first_high.push_back(of_first.high);
    interval.total_low.push_back(of_total.low);
    interval.total_high.push_back(of_total.high);
  }
  return interval;
}

FieldSurrogate draw_surrogate(const FittedField& fitted, std::span<const Index> drawn) {
  FieldSurrogate surrogate = fitted.surrogate;
  surrogate.coefficients = draw_coefficients(fitted, rows_of(fitted), drawn);
  return surrogate;
}

std::vector<std::vector<Index>> draw_samples(Index count, int replicates, std::uint64_t seed) {
  LEFORT_CHECK(count >= 1 && replicates >= 1);
  std::mt19937_64 bits(seed);
  std::vector<std::vector<Index>> draws(std::size_t(replicates), std::vector<Index>{});
  for (std::vector<Index>& draw : draws)
    for (Index k = 0; k < count; ++k) draw.push_back(draw_below(bits, count));
  return draws;
}

}  // namespace lefort::uncertainty
