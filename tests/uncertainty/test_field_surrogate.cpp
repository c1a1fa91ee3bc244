#include <lefort/core/parallel.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "example_models.h"

namespace lefort::uncertainty {
namespace {

constexpr std::array kProbabilities{0.05, 0.5, 0.95};

/// Two fields: one linear in x, one in y, and one of their product.
std::vector<float> linear_field(const VectorX& x, int points) {
  std::vector<float> field;
  for (int v = 0; v < points; ++v) {
    const double s = double(v) / (points - 1);
    field.push_back(float(1.0 + s * x[0] + (1.0 - s) * x[1]));
  }
  return field;
}

struct Fields {
  std::vector<ChaosInput> inputs;
  Eigen::MatrixXd points;
  std::vector<std::vector<float>> samples;
  std::vector<double> weights;
};

Fields make_fields(Index count, int points) {
  const std::vector<Distribution> inputs{normal(2.0, 0.5), uniform(-1.0, 1.0)};
  Fields fields{.inputs = {{inputs[0]}, {inputs[1]}},
                .points = points_at(inputs, nested_latin_hypercube(2, count, 1)),
                .samples = {},
                .weights = std::vector<double>(std::size_t(points), 1.0)};
  for (Index i = 0; i < count; ++i)
    fields.samples.push_back(linear_field(fields.points.row(i).transpose(), points));
  return fields;
}

}  // namespace

TEST(FieldModes, RankOfAFieldOfTwoInputsIsTwo) {
  const Fields fields = make_fields(50, 300);
  const FieldModes found = find_modes(fields.samples, fields.weights, 1.0 - 1e-9);
  EXPECT_EQ(found.modes.cols(), 2);
  EXPECT_LT(found.max_error, 1e-5);
  EXPECT_NEAR((found.modes.transpose() * found.modes - Eigen::MatrixXd::Identity(2, 2)).norm(), 0.0,
              1e-9);
}

TEST(FieldModes, TruncationErrorIsThatOfTheSamples) {
  const Fields fields = make_fields(50, 300);
  const FieldModes found = find_modes(fields.samples, fields.weights, 0.5);
  ASSERT_EQ(found.modes.cols(), 1);
  double squares = 0.0;
  for (Index i = 0; i < 50; ++i)
    for (Index v = 0; v < 300; ++v)
      squares += std::pow(double(fields.samples[std::size_t(i)][std::size_t(v)]) - found.mean[v] -
                              found.modes(v, 0) * found.scores(i, 0),
                          2);
  EXPECT_NEAR(found.rms_error, std::sqrt(squares / (50.0 * 300.0)), 1e-9);
  EXPECT_LT(found.kept, 1.0);
}

TEST(FieldModes, EqualSamplesHaveNone) {
  const std::vector<std::vector<float>> samples(4, {1.0F, 2.0F});
  const FieldModes found = find_modes(samples, std::vector<double>{1.0, 1.0}, 0.999);
  EXPECT_EQ(found.modes.cols(), 0);
  EXPECT_EQ(found.mean[1], 2.0);
}

/// At s = 1 the field is 1 + x with a normal x, at s = 0 it is 1 + y with a uniform y.
TEST(FieldSurrogate, BandOfClosedForms) {
  const Fields fields = make_fields(100, 300);
  const FittedField fitted =
      fit_field(fields.inputs, fields.points, fields.samples, fields.weights, {}).value();
  const std::vector<Distribution> inputs{fields.inputs[0].distribution,
                                         fields.inputs[1].distribution};
  const Eigen::MatrixXd scores =
      scores_at(fitted.surrogate, points_at(inputs, nested_latin_hypercube(2, 4000, 9)));
  const FieldBand band = field_band(fitted.surrogate, scores, kProbabilities).value();
  EXPECT_NEAR(band.quantiles[0].back(), 3.0 - 0.5 * 1.6449, 0.02);
  EXPECT_NEAR(band.quantiles[1].back(), 3.0, 0.01);
  EXPECT_NEAR(band.quantiles[2].back(), 3.0 + 0.5 * 1.6449, 0.02);
  EXPECT_NEAR(band.quantiles[2].front() - band.quantiles[0].front(), 0.9 * 2.0, 0.01);
  EXPECT_NEAR(band.standard_deviation.back(), 0.5, 1e-3);
  EXPECT_NEAR(band.standard_deviation.front(), std::sqrt(1.0 / 3.0), 1e-3);
}

/// A coarse model with a wrong slope plus the correction by few samples of the right one.
TEST(FieldSurrogate, ACorrectionFromFewSamplesIsAdded) {
  const Fields fields = make_fields(100, 50);
  std::vector<std::vector<float>> coarse = fields.samples;
  for (std::size_t i = 0; i < coarse.size(); ++i)
    for (float& value : coarse[i])
      value -= float(0.2 + 0.3 * fields.points(Index(i), 0));  // The error of the coarse model.
  const FittedField rough =
      fit_field(fields.inputs, fields.points, coarse, fields.weights, {}).value();
  std::vector<std::vector<float>> differences;
  for (std::size_t i = 0; i < 8; ++i) {
    differences.emplace_back();
    for (std::size_t v = 0; v < 50; ++v)
      differences.back().push_back(fields.samples[i][v] - coarse[i][v]);
  }
  const FittedField correction = fit_field(fields.inputs, fields.points.topRows(8), differences,
                                           fields.weights, {.basis = {.max_degree = 1}})
                                     .value();
  const FieldSurrogate sum = add(rough.surrogate, correction.surrogate);
  const Eigen::MatrixXd scores = scores_at(sum, fields.points);
  for (Index i = 0; i < 100; ++i)
    for (const Index v : {0, 20, 49})
      EXPECT_NEAR(sum.mean[v] + scores.row(i).dot(sum.modes.row(v)),
                  double(fields.samples[std::size_t(i)][std::size_t(v)]), 2e-3);
}

TEST(FieldSurrogate, BitsDoNotDependOnTheNumberOfThreads) {
  const Fields fields = make_fields(100, 3000);
  const auto band = [&](int threads) {
    const ThreadLimit limit(threads);
    const FittedField fitted =
        fit_field(fields.inputs, fields.points, fields.samples, fields.weights, {}).value();
    return field_band(fitted.surrogate, scores_at(fitted.surrogate, fields.points), kProbabilities)
        .value();
  };
  const FieldBand one = band(1), four = band(4);
  EXPECT_EQ(one.quantiles, four.quantiles);
  EXPECT_EQ(one.standard_deviation, four.standard_deviation);
}

TEST(FieldSurrogate, FitAndBandAreCancelled) {
  struct Stop : Progress {
    [[nodiscard]] bool stop_requested() const override { return true; }
  } stop;
  const Fields fields = make_fields(100, 50);
  const auto fit =
      fit_field(fields.inputs, fields.points, fields.samples, fields.weights, {}, stop);
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::kCancelled);
  const FittedField fitted =
      fit_field(fields.inputs, fields.points, fields.samples, fields.weights, {}).value();
  const auto band = field_band(fitted.surrogate, scores_at(fitted.surrogate, fields.points),
                               kProbabilities, stop);
  ASSERT_FALSE(band);
  EXPECT_EQ(band.error().code, ErrorCode::kCancelled);
}

TEST(SampleQuantile, IsLinearBetweenOrderStatistics) {
  std::vector<double> values{4.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(sample_quantile(values, 0.0), 1.0);
  EXPECT_EQ(sample_quantile(values, 1.0), 4.0);
  EXPECT_EQ(sample_quantile(values, 0.5), 2.5);
  EXPECT_NEAR(sample_quantile(values, 0.9), 3.7, 1e-12);
}

}  // namespace lefort::uncertainty
