#include <lefort/core/parallel.h>
#include <lefort/uncertainty/sobol_indices.h>

#include <gtest/gtest.h>

#include "example_models.h"

namespace lefort::uncertainty {
namespace {

/// A scalar as a field of one point.
FittedField fit_scalar(const ModelRun& made, const BasisOptions& options = {}) {
  std::vector<std::vector<float>> samples;
  for (const double value : made.values) samples.push_back({float(value)});
  return fit_field(made.inputs, made.points, samples, std::vector<double>{1.0},
                   {.variance_fraction = 1.0, .basis = options})
      .value();
}

Eigen::MatrixXd whole(const FittedField& fitted) {
  return gram_of(fitted.surrogate.modes, std::vector<double>(1, 1.0));
}

SurrogateReplicates replicates_of(const FittedField& coarse, const FittedField* correction,
                                  int count) {
  return draw_surrogates(coarse, correction, count, 4, Progress::none()).value();
}

/// Of the sum of a surrogate with itself.
Eigen::MatrixXd twice(const FittedField& fitted) {
  return gram_of(add(fitted.surrogate, fitted.surrogate).modes, std::vector<double>(1, 1.0));
}

/// y = x1 on the coarse mesh; on the fine one 0.5 x2 is added, and what no linear term explains.
struct TwoMeshes {
  std::vector<Distribution> inputs{uniform(-1.0, 1.0), uniform(-1.0, 1.0)};
  FittedField coarse =
      fit_scalar(run(inputs, 100, [](const VectorX& x) { return x[0]; }), {.max_degree = 2});
  FittedField correction = fit_scalar(
      run(
          inputs, 12,
          [](const VectorX& x) { return 0.5 * x[1] + 0.1 * std::sin(9.0 * x[0] * x[1]); }, 7),
      {.max_degree = 1});
  FieldSurrogate total = add(coarse.surrogate, correction.surrogate);
  Eigen::MatrixXd gram = gram_of(total.modes, std::vector<double>(1, 1.0));
};

const std::vector<std::vector<Index>> kTwoInputs{{0}, {1}};

/// Requests a stop at once.
struct StopProgress : Progress {
  [[nodiscard]] bool stop_requested() const override { return true; }
};

}  // namespace

/// Variance 13.8446 and indices in closed form: verify/uncertain_bar.cpp.
TEST(SobolIndices, OfTheIshigamiFunction) {
  const FittedField fitted = fit_scalar(run(ishigami_inputs(), 400, ishigami));
  const SobolIndices found = sobol_indices(fitted.surrogate.basis, fitted.surrogate.coefficients,
                                           whole(fitted), kThreeInputs);
  EXPECT_NEAR(found.variance, 13.8446, 0.02 * 13.8446);
  EXPECT_NEAR(found.first[0], 0.3139, 0.01);
  EXPECT_NEAR(found.first[1], 0.4424, 0.01);
  EXPECT_NEAR(found.first[2], 0.0, 0.01);
  EXPECT_NEAR(found.total[0], 0.5576, 0.01);
  EXPECT_NEAR(found.total[1], 0.4424, 0.01);
  EXPECT_NEAR(found.total[2], 0.2437, 0.01);
}

/// u = sum a_i x_i + b x1 x2: Var = sum a_i^2 s_i^2 + interaction terms in closed form.
TEST(SobolIndices, OfALinearResponseWithAProduct) {
  const std::vector<Distribution> inputs{
      normal(2.0, 0.5),
      uniform(-1.0, 3.0),
      {.kind = DistributionKind::kLogNormal, .mean = 3.0, .standard_deviation = 0.6},
      {.kind = DistributionKind::kTriangular, .low = 0.0, .high = 2.0, .mode = 0.5}};
  const VectorX a{{1.5, -2.0, 0.7, 3.0}};
  const double b = 0.8;
  const FittedField fitted =
      fit_scalar(run(inputs, 100, [&](const VectorX& x) { return a.dot(x) + b * x[0] * x[1]; }));
  std::vector<Moments> m;
  for (const Distribution& one : inputs) m.push_back(moments_of(one));
  const double v0 = std::pow(a[0] + b * m[1].mean, 2) * m[0].variance;
  const double v1 = std::pow(a[1] + b * m[0].mean, 2) * m[1].variance;
  const double v01 = b * b * m[0].variance * m[1].variance;
  const double v2 = a[2] * a[2] * m[2].variance, v3 = a[3] * a[3] * m[3].variance;
  const double variance = v0 + v1 + v01 + v2 + v3;
  const std::vector<std::vector<Index>> groups{{0}, {1}, {2}, {3}, {0, 1}};
  const SobolIndices found =
      sobol_indices(fitted.surrogate.basis, fitted.surrogate.coefficients, whole(fitted), groups);
  EXPECT_NEAR(found.variance, variance, 1e-4 * variance);  // Samples are floats.
  EXPECT_NEAR(found.first[0], v0 / variance, 1e-4);
  EXPECT_NEAR(found.total[0], (v0 + v01) / variance, 1e-4);
  EXPECT_NEAR(found.first[2], v2 / variance, 1e-4);
  EXPECT_NEAR(found.total[3], v3 / variance, 1e-4);
  EXPECT_NEAR(found.first[4], (v0 + v1 + v01) / variance, 1e-4);  // A group of inputs.
  EXPECT_NEAR(found.total[4], found.first[4], 1e-6);
}

TEST(SobolIndices, BootstrapIntervalsContainTheIndices) {
  const FittedField fitted = fit_scalar(run(ishigami_inputs(), 200, ishigami));
  const SobolInterval interval =
      sobol_interval(replicates_of(fitted, nullptr, 100), whole(fitted), kThreeInputs, 0.95);
  EXPECT_LT(interval.first_low[0], 0.3139);
  EXPECT_GT(interval.first_high[0], 0.3139);
  EXPECT_LT(interval.total_high[0] - interval.total_low[0], 0.1);
  EXPECT_GT(interval.total_high[0] - interval.total_low[0], 0.0);
}

TEST(SobolIndices, BootstrapOfBothMeshesContainsTheIndexOfTheCorrection) {
  const TwoMeshes both;
  const SobolIndices found =
      sobol_indices(both.total.basis, both.total.coefficients, both.gram, kTwoInputs);
  EXPECT_NEAR(found.first[1], 0.2, 0.05);  // 0.25 / 1.25.
  const SobolInterval interval =
      sobol_interval(replicates_of(both.coarse, &both.correction, 200), both.gram, kTwoInputs, 0.9);
  for (const std::size_t input : {0U, 1U}) {
    EXPECT_LT(interval.first_low[input], found.first[input]);
    EXPECT_GT(interval.first_high[input], found.first[input]);
  }
  EXPECT_GT(interval.first_high[1] - interval.first_low[1], 0.01);
  EXPECT_LT(interval.first_high[1] - interval.first_low[1], 0.2);
  // The coarse model alone has no such input.
  const SobolInterval coarse =
      sobol_interval(replicates_of(both.coarse, nullptr, 200), whole(both.coarse), kTwoInputs, 0.9);
  EXPECT_LT(coarse.first_high[1], 1e-6);
}

/// The selection found no dependence on the inputs: a replicate finds none either.
TEST(SobolIndices, ACorrectionWithoutCoefficientsChangesNoInterval) {
  TwoMeshes both;
  both.correction.surrogate.coefficients.setZero();
  const SobolInterval with =
      sobol_interval(replicates_of(both.coarse, &both.correction, 50), both.gram, kTwoInputs, 0.9);
  const SobolInterval without =
      sobol_interval(replicates_of(both.coarse, nullptr, 50), whole(both.coarse), kTwoInputs, 0.9);
  for (const std::size_t input : {0U, 1U}) {
    EXPECT_NEAR(with.first_low[input], without.first_low[input], 1e-12);
    EXPECT_NEAR(with.total_high[input], without.total_high[input], 1e-12);
  }
}

TEST(SobolIndices, ReplicatesAreFiniteForTheFewestSamples) {
  const ModelRun made = run({uniform(0.0, 1.0)}, 6, [](const VectorX& x) { return x[0] * x[0]; });
  const FittedField few = fit_scalar(made, {.max_degree = 1});
  const SurrogateReplicates found = replicates_of(few, nullptr, 500);
  ASSERT_EQ(found.coefficients.size(), 500U);
  for (const Eigen::MatrixXd& one : found.coefficients) EXPECT_LT(one.cwiseAbs().maxCoeff(), 10.0);
}

TEST(SobolIndices, ABootstrapIsCancelled) {
  const TwoMeshes both;
  StopProgress stop;
  const auto found = draw_surrogates(both.coarse, &both.correction, 200, 4, stop);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kCancelled);
}

TEST(SobolIndices, AConstantHasNone) {
  const FittedField fitted =
      fit_scalar(run({uniform(0.0, 1.0)}, 30, [](const VectorX&) { return 2.0; }));
  const SobolIndices found = sobol_indices(fitted.surrogate.basis, fitted.surrogate.coefficients,
                                           whole(fitted), std::vector<std::vector<Index>>{{0}});
  EXPECT_EQ(found.variance, 0.0);
  EXPECT_EQ(found.first[0], 0.0);
}

TEST(SobolIndices, BitsDoNotDependOnTheNumberOfThreads) {
  const ModelRun made = run(ishigami_inputs(), 200, ishigami);
  const auto intervals = [&](int threads) {
    const ThreadLimit limit(threads);
    const FittedField fitted = fit_scalar(made);
    return sobol_interval(replicates_of(fitted, &fitted, 40), twice(fitted), kThreeInputs, 0.9)
        .total_high;
  };
  EXPECT_EQ(intervals(1), intervals(4));
}

}  // namespace lefort::uncertainty
