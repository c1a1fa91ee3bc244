#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/core/random_draws.h>
#include <lefort/uncertainty/sobol_indices.h>

#include <algorithm>
#include <optional>
#include <random>
#include <set>
#include <utility>

namespace lefort::uncertainty {
namespace {

/// Draws of the correction differ from those of the coarse model.
constexpr std::uint64_t kCorrectionSeed = 0x94d049bb133111ebULL;

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

/// Draws `count` of `count` numbers with replacement, `replicates` times.
///
/// \param distinct  fewest different numbers of a draw; other draws are repeated.
std::vector<std::vector<Index>> draw_samples(Index count, std::size_t distinct, int replicates,
                                             std::uint64_t seed) {
  LEFORT_CHECK(count >= 1 && replicates >= 1 && Index(distinct) <= count);
  std::mt19937_64 bits(seed);
  std::vector<std::vector<Index>> draws(std::size_t(replicates), std::vector<Index>{});
  for (std::vector<Index>& draw : draws) do {
      draw.clear();
      for (Index k = 0; k < count; ++k) draw.push_back(draw_below(bits, count));
    } while (std::set<Index>(draw.begin(), draw.end()).size() < distinct);
  return draws;
}

/// Replicates of one surrogate, without the points of its field: only the coefficients differ.
class Replicator {
 public:
  Replicator(const FittedField& fitted, int replicates, std::uint64_t seed)
      : fitted_(fitted), rows_(rows_of(fitted)) {
    std::size_t most = 1;
    for (const ChaosFit& fit : fitted.fits) most = std::max(most, fit.terms.size());
    draws_ = draw_samples(fitted.basis_values.rows(), most, replicates, seed);
  }

  [[nodiscard]] FieldSurrogate at(Index replicate) const {
    const Eigen::MatrixXd& selected = fitted_.surrogate.coefficients;
    FieldSurrogate drawn{.basis = fitted_.surrogate.basis,
                         .mean = VectorX(0),
                         .modes = Eigen::MatrixXd(0, selected.cols()),
                         .coefficients = Eigen::MatrixXd::Zero(selected.rows(), selected.cols())};
    for (Index k = 0; k < selected.cols(); ++k) {
      if ((selected.col(k).array() == 0.0).all()) continue;
      const ChaosFit& fit = fitted_.fits[std::size_t(k)];
      const VectorX again = refit(fitted_.basis_values, fit, fitted_.modes.scores.col(k),
                                  draws_[std::size_t(replicate)]);
      for (std::size_t t = 0; t < fit.terms.size(); ++t)
        if (const Index row = rows_[std::size_t(fit.terms[t])]; row >= 0)
          drawn.coefficients(row, k) = again[Index(t)];
    }
    return drawn;
  }

 private:
  const FittedField& fitted_;
  std::vector<Index> rows_;
  std::vector<std::vector<Index>> draws_;
};

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

Result<SurrogateReplicates> draw_surrogates(const FittedField& coarse,
                                            const FittedField* correction, int replicates,
                                            std::uint64_t seed, Progress& progress) {
  const Replicator of_coarse(coarse, replicates, seed);
  std::optional<Replicator> of_correction;
  if (correction != nullptr) of_correction.emplace(*correction, replicates, seed ^ kCorrectionSeed);
  SurrogateReplicates found;
  found.coefficients.resize(std::size_t(replicates));
  const auto replicate = [&](Index b) {
    const FieldSurrogate one = of_coarse.at(b);
    return of_correction ? add(one, of_correction->at(b)) : one;
  };
  found.basis = replicate(0).basis;
  constexpr Index kBatch = 16;
  for (Index begin = 0; begin < replicates; begin += kBatch) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "stopped");
    const Index count = std::min<Index>(kBatch, replicates - begin);
    parallel_for(
        count,
        [&](Index k) {
          found.coefficients[std::size_t(begin + k)] = replicate(begin + k).coefficients;
        },
        1);
    progress.report(double(begin + count) / double(replicates));
  }
  return found;
}

SobolInterval sobol_interval(const SurrogateReplicates& replicates, const Eigen::MatrixXd& gram,
                             std::span<const std::vector<Index>> groups, double level) {
  std::vector<SobolIndices> found(replicates.coefficients.size());
  parallel_for(
      Index(found.size()),
      [&](Index b) {
        found[std::size_t(b)] =
            sobol_indices(replicates.basis, replicates.coefficients[std::size_t(b)], gram, groups);
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

}  // namespace lefort::uncertainty
