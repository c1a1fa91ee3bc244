#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/uncertainty/field_surrogate.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lefort::uncertainty {
namespace {

/// Without terms whose coefficients are all zero, so that evaluation is fast.
FieldSurrogate without_unused_terms(FieldSurrogate surrogate) {
  std::vector<ChaosTerm> terms;
  std::vector<Index> rows;
  for (Index t = 0; t < surrogate.coefficients.rows(); ++t)
    if (t == 0 || (surrogate.coefficients.row(t).array() != 0.0).any()) {
      terms.push_back(surrogate.basis.terms[std::size_t(t)]);
      rows.push_back(t);
    }
  Eigen::MatrixXd kept(Index(rows.size()), surrogate.coefficients.cols());
  for (std::size_t k = 0; k < rows.size(); ++k)
    kept.row(Index(k)) = surrogate.coefficients.row(rows[k]);
  surrogate.basis.terms = std::move(terms);
  surrogate.basis.candidate_ends = {Index(surrogate.basis.terms.size())};
  surrogate.coefficients = std::move(kept);
  return surrogate;
}

}  // namespace

Result<FittedField> fit_field(const std::vector<ChaosInput>& inputs, const Eigen::MatrixXd& points,
                              std::span<const std::vector<float>> samples,
                              std::span<const double> weights, const FieldFitOptions& options,
                              Progress& progress) {
  LEFORT_CHECK(points.rows() == Index(samples.size()) && samples.size() >= 3);
  FittedField fitted;
  fitted.modes = find_modes(samples, weights, options.variance_fraction);
  const ChaosBasis basis = make_basis(inputs, options.basis);
  fitted.basis_values = evaluate(basis, points);
  const Index modes = fitted.modes.scores.cols();
  fitted.fits.resize(std::size_t(modes));
  fitted.cv_errors.resize(points.rows(), modes);
  const Index folds = std::min(options.folds, points.rows());
  constexpr Index kBatch = 8;  // Modes.
  for (Index begin = 0; begin < modes; begin += kBatch) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "stopped");
    const Index count = std::min(kBatch, modes - begin);
    parallel_for(
        count,
        [&](Index n) {
          const Index k = begin + n;
          const VectorX scores = fitted.modes.scores.col(k);
          ChaosFit& fit = fitted.fits[std::size_t(k)];
          fit = fit_chaos(fitted.basis_values, basis.candidate_ends, scores);
          fitted.cv_errors.col(k) = cross_validate(fitted.basis_values, basis.candidate_ends,
                                                   fit.candidate, scores, folds);
        },
        1);
    progress.report(double(begin + count) / double(modes));
  }
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(Index(basis.terms.size()), modes);
  for (Index k = 0; k < modes; ++k) {
    const ChaosFit& fit = fitted.fits[std::size_t(k)];
    for (std::size_t t = 0; t < fit.terms.size(); ++t)
      coefficients(fit.terms[t], k) = fit.coefficients[Index(t)];
  }
  fitted.surrogate =
      without_unused_terms({basis, fitted.modes.mean, fitted.modes.modes, std::move(coefficients)});
  return fitted;
}

FieldSurrogate add(const FieldSurrogate& a, const FieldSurrogate& b) {
  LEFORT_CHECK(a.mean.size() == b.mean.size() && a.basis.inputs.size() == b.basis.inputs.size());
  FieldSurrogate sum{.basis = a.basis, .mean = a.mean + b.mean, .modes = {}, .coefficients = {}};
  std::map<ChaosTerm, Index> rows;
  for (const ChaosTerm& term : a.basis.terms) rows.emplace(term, Index(rows.size()));
  for (const ChaosTerm& term : b.basis.terms)
    if (rows.emplace(term, Index(rows.size())).second) sum.basis.terms.push_back(term);
  sum.basis.candidate_ends = {Index(sum.basis.terms.size())};
  const Index of_a = a.modes.cols();
  sum.modes.resize(a.modes.rows(), of_a + b.modes.cols());
  sum.modes << a.modes, b.modes;
  sum.coefficients = Eigen::MatrixXd::Zero(Index(sum.basis.terms.size()), sum.modes.cols());
  sum.coefficients.topLeftCorner(a.coefficients.rows(), of_a) = a.coefficients;
  for (std::size_t t = 0; t < b.basis.terms.size(); ++t)
    sum.coefficients.row(rows.at(b.basis.terms[t])).tail(b.modes.cols()) =
        b.coefficients.row(Index(t));
  return sum;
}

Eigen::MatrixXd scores_at(const FieldSurrogate& surrogate, const Eigen::MatrixXd& points) {
  return evaluate(surrogate.basis, points) * surrogate.coefficients;
}

Result<FieldBand> field_band(const FieldSurrogate& surrogate, const Eigen::MatrixXd& scores,
                             std::span<const double> probabilities, Progress& progress) {
  const Index points = surrogate.mean.size();
  FieldBand band;
  band.quantiles.assign(probabilities.size(), std::vector<double>(std::size_t(points)));
  band.standard_deviation.resize(std::size_t(points));
  const Index rows = surrogate.coefficients.rows();
  const auto find = [&](Index v) {
    const VectorX at = surrogate.modes.row(v).transpose();
    VectorX values = (scores * at).array() + surrogate.mean[v];
    for (std::size_t q = 0; q < probabilities.size(); ++q)
      band.quantiles[q][std::size_t(v)] =
          sample_quantile({values.data(), std::size_t(values.size())}, probabilities[q]);
    const VectorX terms = surrogate.coefficients * at;  // The first is the constant.
    band.standard_deviation[std::size_t(v)] = rows > 1 ? terms.tail(rows - 1).norm() : 0.0;
  };
  constexpr Index kBatch = 16 * kParallelBlock;  // Points.
  for (Index begin = 0; begin < points; begin += kBatch) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "stopped");
    const Index count = std::min(kBatch, points - begin);
    parallel_for(count, [&](Index n) { find(begin + n); });
    progress.report(double(begin + count) / double(points));
  }
  return band;
}

double sample_quantile(std::span<double> values, double probability) {
  LEFORT_CHECK(!values.empty() && probability >= 0.0 && probability <= 1.0);
  const double at = probability * double(values.size() - 1);
  const auto below = std::size_t(at);
  const auto middle = values.begin() + std::ptrdiff_t(below);
  std::nth_element(values.begin(), middle, values.end());
  const double low = *middle;
  if (below + 1 == values.size()) return low;
  const double high = *std::min_element(middle + 1, values.end());
  return low + (at - double(below)) * (high - low);
}

}  // namespace lefort::uncertainty
