/// \file
/// Bounded fits to cases with known parameters.
#include <lefort/pipeline/validate/calibration_parameters.h>
#include <lefort/pipeline/validate/fit_parameters.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace lefort::pipeline::test_fit_parameters {
namespace {

constexpr std::array<Index, 3> kCases{0, 1, 2};

/// Distances that depend on two parameters, with other noise in each case.
CaseResidual residual_at(Index number, const VectorX& at, const VectorX& truth, double noise) {
  CaseResidual residual;
  for (int p = 0; p < 40; ++p) {
    const double x = 0.1 * p;
    const auto model = [&](const VectorX& t) {
      return 3.0 * t[0] * std::sin(x) + std::exp(t[1]) * std::cos(2.0 * x + double(number));
    };
    residual.signed_mm.push_back(model(at) - model(truth) +
                                 noise * std::sin(17.0 * p + 5.0 * double(number)));
    residual.weight.push_back(1.0 + 0.5 * (p % 3));
  }
  return residual;
}

FitProblem problem_with(const VectorX& truth, double noise = 0.0) {
  return {{0.05, 0.05},
          [=](Index number, const VectorX& at) -> Result<CaseResidual> {
            return residual_at(number, at, truth, noise);
          },
          [](const Error& error) { return error.code != ErrorCode::kCancelled; }};
}

const VectorX kStart = Eigen::Vector2d(0.5, 0.5);

TEST(FitParameters, FindsTheParametersWithoutNoise) {
  const VectorX truth = Eigen::Vector2d(0.8, 0.2);
  const auto fit = fit_parameters(problem_with(truth), kCases, kStart, {.max_iterations = 20});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_TRUE(fit->converged);
  EXPECT_LT((fit->at - truth).norm(), 2e-3) << fit->at.transpose();
  EXPECT_LT(fit->objective, 1e-5);
}

TEST(FitParameters, TheIntervalContainsTheTruth) {
  const VectorX truth = Eigen::Vector2d(0.7, 0.4);
  const auto fit = fit_parameters(problem_with(truth, 0.1), kCases, kStart, {.max_iterations = 20});
  ASSERT_TRUE(fit) << fit.error().message;
  const auto intervals = fit_intervals(*fit);
  for (Index p = 0; p < 2; ++p) {
    EXPECT_LE(intervals[std::size_t(p)].low, truth[p]);
    EXPECT_GE(intervals[std::size_t(p)].high, truth[p]);
    EXPECT_LT(intervals[std::size_t(p)].high - intervals[std::size_t(p)].low, 0.2);
  }
}

TEST(FitParameters, StaysWithinTheBounds) {
  const VectorX truth = Eigen::Vector2d(1.3, 0.3);
  const auto fit = fit_parameters(problem_with(truth), kCases, kStart, {.max_iterations = 30});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_DOUBLE_EQ(fit->at[0], 1.0);
  EXPECT_TRUE(fit->converged);
}

/// A case that fails at some parameters is no minimum.
TEST(FitParameters, AvoidsParametersWithoutAResult) {
  FitProblem problem = problem_with(Eigen::Vector2d(0.9, 0.5));
  const auto inner = problem.residual;
  problem.residual = [inner](Index number, const VectorX& at) -> Result<CaseResidual> {
    if (at[0] > 0.7) return fail(ErrorCode::kNotConverged, "no equilibrium");
    return inner(number, at);
  };
  const auto fit = fit_parameters(problem, kCases, kStart, {.max_iterations = 30});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_LE(fit->at[0], 0.7);
  EXPECT_GT(fit->at[0], 0.6);
}

TEST(FitParameters, EndsIfTheUserStopsIt) {
  FitProblem problem = problem_with(Eigen::Vector2d(0.9, 0.5));
  problem.residual = [](Index, const VectorX&) -> Result<CaseResidual> {
    return fail(ErrorCode::kCancelled, "stopped");
  };
  EXPECT_EQ(fit_parameters(problem, kCases, kStart).error().code, ErrorCode::kCancelled);
}

TEST(FitParameters, PointsThatAreNotComparedDoNotCount) {
  const VectorX truth = Eigen::Vector2d(0.6, 0.6);
  FitProblem problem = problem_with(truth);
  const auto inner = problem.residual;
  problem.residual = [inner](Index number, const VectorX& at) {
    auto residual = inner(number, at);
    residual->signed_mm[std::size_t(number)] = NAN;
    return residual;
  };
  const auto fit = fit_parameters(problem, kCases, kStart, {.max_iterations = 20});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_LT((fit->at - truth).norm(), 2e-3);
}

TEST(CalibrationParameters, AreReadFromAndWrittenIntoPlans) {
  for (const CalibrationParameter& one : calibration_parameters()) {
    io::PlanFile plan;
    const double middle = one.value(0.4);
    one.set(plan, middle);
    EXPECT_NEAR(one.get(plan), middle, 1e-12) << one.name;
    EXPECT_NEAR(one.coordinate(middle), 0.4, 1e-12) << one.name;
    EXPECT_NEAR(one.value(0.0), one.low, 1e-12) << one.name;
    EXPECT_NEAR(one.value(1.0), one.high, 1e-9) << one.name;
    EXPECT_GT(one.coordinate_step(), 0.0) << one.name;
    EXPECT_LT(one.coordinate_step(), 0.3) << one.name;
  }
}

/// The keys in the report give the fitted prediction.
TEST(CalibrationParameters, KeysGiveThePlanWithTheValue) {
  for (const CalibrationParameter& one : calibration_parameters()) {
    nlohmann::ordered_json text = nlohmann::ordered_json::parse(R"({
      "lefort_plan": 1,
      "segments": [{"name": "mandible", "osteotomy": {"bone": "mandible"},
                    "path": {"keyframes": [{"translation_mm": [0, 3, 0]}]}}]})");
    const auto before = io::parse_plan(text.dump(), ".");
    ASSERT_TRUE(before) << before.error().message;
    EXPECT_TRUE(before->segments[0].is_whole_mandible);
    const double value = one.value(0.3);
    text.merge_patch(one.keys(*before, value));
    const auto after = io::parse_plan(text.dump(), ".");
    ASSERT_TRUE(after) << one.name << ": " << after.error().message;
    EXPECT_NEAR(one.get(*after), value, 1e-9) << one.name;
  }
}

TEST(CalibrationParameters, UnknownAndRepeatedNamesAreRejected) {
  const std::vector<std::string> unknown{"skin_ratio", "color"}, twice{"poisson", "poisson"};
  EXPECT_NE(find_parameters(unknown).error().message.find("there is no parameter color"),
            std::string::npos);
  EXPECT_NE(find_parameters(twice).error().message.find("named twice"), std::string::npos);
  EXPECT_EQ(find_parameters(default_parameters())->size(), default_parameters().size());
}

}  // namespace
}  // namespace lefort::pipeline::test_fit_parameters
