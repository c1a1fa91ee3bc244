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
                   {.variance_fraction = 1.0, .basis = options});
}

Eigen::MatrixXd whole(const FittedField& fitted) {
  return gram_of(fitted.surrogate.modes, std::vector<double>(1, 1.0));
}

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
  const SobolInterval interval = sobol_bootstrap(fitted, whole(fitted), kThreeInputs, 100, 0.95, 4);
  EXPECT_LT(interval.first_low[0], 0.3139);
  EXPECT_GT(interval.first_high[0], 0.3139);
  EXPECT_LT(interval.total_high[0] - interval.total_low[0], 0.1);
  EXPECT_GT(interval.total_high[0] - interval.total_low[0], 0.0);
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
    return sobol_bootstrap(fitted, whole(fitted), kThreeInputs, 40, 0.9, 4).total_high;
  };
  EXPECT_EQ(intervals(1), intervals(4));
}

}  // namespace lefort::uncertainty
