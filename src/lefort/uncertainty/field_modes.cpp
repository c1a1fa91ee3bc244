#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/uncertainty/field_modes.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace lefort::uncertainty {
namespace {

VectorX mean_of(std::span<const std::vector<float>> samples) {
  const auto points = Index(samples.front().size());
  VectorX mean = VectorX::Zero(points);
  parallel_for(points, [&](Index v) {
    for (const std::vector<float>& sample : samples) mean[v] += double(sample[std::size_t(v)]);
    mean[v] /= double(samples.size());
  });
  return mean;
}

/// Deviations of all samples from the mean at one point.
VectorX deviations(std::span<const std::vector<float>> samples, const VectorX& mean, Index v) {
  VectorX at(Index(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i)
    at[Index(i)] = double(samples[i][std::size_t(v)]) - mean[v];
  return at;
}

/// Weighted inner products of the deviations of the samples.
Eigen::MatrixXd inner_products(std::span<const std::vector<float>> samples, const VectorX& mean,
                               std::span<const double> weights) {
  const auto count = Index(samples.size());
  // Few partial sums: each is a matrix. Their number does not depend on the number of threads.
  constexpr Index kBlocks = 16;
  const Index points = mean.size();
  std::vector<Eigen::MatrixXd> partial(std::size_t(kBlocks), Eigen::MatrixXd::Zero(count, count));
  parallel_for(
      kBlocks,
      [&](Index b) {
        const Index begin = b * points / kBlocks, end = (b + 1) * points / kBlocks;
        if (begin == end) return;
        Eigen::MatrixXd columns(count, end - begin);
        for (Index v = begin; v < end; ++v)
          columns.col(v - begin) =
              std::sqrt(weights[std::size_t(v)]) * deviations(samples, mean, v);
        partial[std::size_t(b)].selfadjointView<Eigen::Lower>().rankUpdate(columns);
      },
      1);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count, count);
  for (const Eigen::MatrixXd& one : partial) sum += one;
  return sum.selfadjointView<Eigen::Lower>();
}

void measure_errors(std::span<const std::vector<float>> samples, std::span<const double> weights,
                    FieldModes& found) {
  const Index points = found.mean.size();
  VectorX largest = VectorX::Zero(points), squares = VectorX::Zero(points);
  parallel_for(points, [&](Index v) {
    VectorX rest = deviations(samples, found.mean, v);
    rest.noalias() -= found.scores * found.modes.row(v).transpose();
    largest[v] = rest.cwiseAbs().maxCoeff();
    squares[v] = weights[std::size_t(v)] * rest.squaredNorm() / double(samples.size());
  });
  double total = 0.0;
  for (const double weight : weights) total += weight;
  found.max_error = largest.maxCoeff();
  found.rms_error = std::sqrt(squares.sum() / total);
}

}  // namespace

FieldModes find_modes(std::span<const std::vector<float>> samples, std::span<const double> weights,
                      double fraction) {
  LEFORT_CHECK(!samples.empty() && !weights.empty());
  for (const std::vector<float>& sample : samples) LEFORT_CHECK(sample.size() == weights.size());
  FieldModes found;
  found.mean = mean_of(samples);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      inner_products(samples, found.mean, weights));
  const VectorX variances = solver.eigenvalues().reverse().cwiseMax(0.0);  // Descending.
  const double total = variances.sum();
  constexpr double kRoundOff = 1e-13;
  Index count = 0;
  double sum = 0.0;
  while (count < variances.size() && sum < fraction * total && variances[count] > kRoundOff * total)
    sum += variances[count++];
  found.kept = total > 0.0 ? sum / total : 1.0;
  found.scores.resize(Index(samples.size()), count);
  found.modes.resize(found.mean.size(), count);
  for (Index k = 0; k < count; ++k) {
    VectorX axis = solver.eigenvectors().col(variances.size() - 1 - k);
    Index at = 0;  // The sign of an eigenvector is arbitrary: its largest entry is positive.
    axis.cwiseAbs().maxCoeff(&at);
    if (axis[at] < 0.0) axis = -axis;
    found.scores.col(k) = std::sqrt(variances[k]) * axis;
  }
  parallel_for(found.mean.size(), [&](Index v) {
    const VectorX at = deviations(samples, found.mean, v);
    for (Index k = 0; k < count; ++k)
      found.modes(v, k) = at.dot(found.scores.col(k)) / variances[k];
  });
  measure_errors(samples, weights, found);
  return found;
}

}  // namespace lefort::uncertainty
