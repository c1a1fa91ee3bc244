#include <lefort/inverse/bounded_least_squares.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "support/stop_at_once.h"

namespace lefort::inverse::test_bounded_least_squares {
namespace {

/// Residuals and their derivatives in closed form.
class Residuals final : public LeastSquaresFunction {
 public:
  using Function = std::function<VectorX(const VectorX&)>;
  using Derivative = std::function<Eigen::MatrixXd(const VectorX&)>;
  Residuals(Function r, Derivative D) : r_(std::move(r)), D_(std::move(D)) {}

  [[nodiscard]] Result<double> evaluate(const VectorX& x) override {
    ++evaluations;
    if (fails_beyond && x.norm() > *fails_beyond)
      return fail(ErrorCode::kNotConverged, "no equilibrium");
    trial_ = x;
    return 0.5 * r_(x).squaredNorm();
  }
  void accept() override { x_ = trial_; }
  [[nodiscard]] Result<QuadraticModel> linearize() override {
    const Eigen::MatrixXd D = D_(x_);
    return QuadraticModel{D.transpose() * r_(x_), D.transpose() * D};
  }

  std::optional<double> fails_beyond;
  int evaluations = 0;

 private:
  Function r_;
  Derivative D_;
  VectorX x_, trial_;
};

VectorX vector(std::initializer_list<double> values) {
  VectorX x{Index(values.size())};
  Index i = 0;
  for (const double value : values) x[i++] = value;
  return x;
}

/// Rosenbrock's function as residuals; minimum 0 at (1, 1).
Residuals rosenbrock() {
  return {[](const VectorX& x) {
            return vector({10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]});
          },
          [](const VectorX& x) {
            Eigen::MatrixXd D(2, 2);
            D << -20.0 * x[0], 10.0, -1.0, 0.0;
            return D;
          }};
}

const LeastSquaresOptions kPrecise{.max_iterations = 200, .step_tolerance = 1e-9};

TEST(BoundedLeastSquares, FindsTheMinimumOfACurvedValley) {
  Residuals function = rosenbrock();
  const auto found = minimize_least_squares(function, vector({-1.2, 1.0}), vector({-9, -9}),
                                            vector({9, 9}), kPrecise)
                         .value();
  EXPECT_LT((found.x - vector({1.0, 1.0})).norm(), 1e-6);
  EXPECT_EQ(found.stop, LeastSquaresStop::kConverged);
  for (std::size_t n = 1; n < found.history.size(); ++n) EXPECT_GE(found.history[n].x.size(), 2);
}

TEST(BoundedLeastSquares, EndsAtABoundWhereTheObjectivePushesAgainstIt) {
  // With x_0 <= 0.5 the minimum is at x_0 = 0.5, x_1 = 0.25 in closed form.
  Residuals function = rosenbrock();
  const auto found = minimize_least_squares(function, vector({-1.2, 1.0}), vector({-2, -2}),
                                            vector({0.5, 2}), kPrecise)
                         .value();
  EXPECT_LT((found.x - vector({0.5, 0.25})).norm(), 1e-6);
  EXPECT_EQ(found.at_upper[0], 1);
  EXPECT_EQ(found.at_upper[1], 0);
  EXPECT_EQ(found.at_lower[0] + found.at_lower[1], 0);
  for (const LeastSquaresIterate& one : found.history) {
    EXPECT_LE(one.x[0], 0.5);
    EXPECT_GE(one.x.minCoeff(), -2.0);
  }
}

TEST(BoundedLeastSquares, LeavesWhatTheResidualsDoNotDetermineAlone) {
  Residuals function([](const VectorX& x) { return vector({x[0] + x[1] - 2.0}); },
                     [](const VectorX&) {
                       return Eigen::MatrixXd(Eigen::MatrixXd::Ones(1, 3).cwiseProduct(
                           (Eigen::MatrixXd(1, 3) << 1.0, 1.0, 0.0).finished()));
                     });
  const auto found = minimize_least_squares(function, vector({0.0, 0.0, 0.7}), vector({-9, -9, -9}),
                                            vector({9, 9, 9}), kPrecise)
                         .value();
  EXPECT_NEAR(found.x[0], 1.0, 1e-6);  // The step of least length.
  EXPECT_NEAR(found.x[1], 1.0, 1e-6);
  EXPECT_EQ(found.x[2], 0.7);
}

TEST(BoundedLeastSquares, ShortensStepsToPointsThatCannotBeEvaluated) {
  Residuals function([](const VectorX& x) { return vector({x[0] - 3.0}); },
                     [](const VectorX&) { return Eigen::MatrixXd(Eigen::MatrixXd::Ones(1, 1)); });
  function.fails_beyond = 2.0;
  const auto found =
      minimize_least_squares(function, vector({0.0}), vector({-9}), vector({9}), kPrecise).value();
  EXPECT_LE(found.x[0], 2.0);
  EXPECT_GT(found.x[0], 1.5);
}

TEST(BoundedLeastSquares, IsCancelled) {
  Residuals function = rosenbrock();
  test::StopAtOnce stop;
  const auto found = minimize_least_squares(function, vector({-1.2, 1.0}), vector({-9, -9}),
                                            vector({9, 9}), kPrecise, stop);
  EXPECT_EQ(found.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::inverse::test_bounded_least_squares
