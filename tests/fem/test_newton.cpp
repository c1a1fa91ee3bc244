#include <lefort/core/check.h>
#include <lefort/fem/solve/newton.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "linear/little_memory.h"

namespace lefort::fem::test_newton {
namespace {

linear::SparseMatrix sparse(const Eigen::MatrixXd& A) {
  linear::SparseMatrix S(A.rows(), A.cols());
  for (Index j = 0; j < A.cols(); ++j)
    for (Index i = j; i < A.rows(); ++i) S.insert(i, j) = A(i, j);
  S.makeCompressed();
  return S;
}

/// One unknown with a given energy, its slope and its curvature, for x in `domain`.
class Scalar final : public NonlinearSystem {
 public:
  using Function = std::function<double(double)>;
  Scalar(
      Function energy, Function slope, Function curvature,
      std::function<bool(double)> domain = [](double) { return true; })
      : energy_(std::move(energy)),
        slope_(std::move(slope)),
        curvature_(std::move(curvature)),
        domain_(std::move(domain)) {}

  std::optional<ResidualState> residual_state(const VectorX& x) const override {
    if (!domain_(x[0])) return std::nullopt;
    return ResidualState{.energy_mj = energy_(x[0]),
                         .residual_n = VectorX::Constant(1, slope_(x[0])),
                         .residual_reference_n = 1.0,
                         .energy_round_off_mj = 1e-15};
  }
  linear::SparseMatrix tangent(const VectorX& x, Tangent) const override {
    LEFORT_CHECK(domain_(x[0]));
    return sparse(Eigen::MatrixXd::Constant(1, 1, curvature_(x[0])));
  }

 private:
  Function energy_, slope_, curvature_;
  std::function<bool(double)> domain_;
};

NewtonOutcome solve(const NonlinearSystem& system, double start, const NewtonOptions& options = {},
                    Progress& progress = Progress::none()) {
  linear::LinearSolver solver;
  return solve_newton(system, VectorX::Constant(1, start), solver, options, progress);
}

/// W = x - ln x on x > 0, its minimum at 1. From x > 2 the full Newton step leaves the domain.
Scalar barrier() {
  return {[](double x) { return x - std::log(x); }, [](double x) { return 1.0 - 1.0 / x; },
          [](double x) { return 1.0 / (x * x); }, [](double x) { return x > 0.0; }};
}

/// W = (x^2 - 1)^2 / 4: curvature is negative between -1/sqrt(3) and 1/sqrt(3).
Scalar double_well() {
  return {[](double x) { return 0.25 * (x * x - 1.0) * (x * x - 1.0); },
          [](double x) { return x * (x * x - 1.0); }, [](double x) { return 3.0 * x * x - 1.0; }};
}

TEST(Newton, ConvergesQuadratically) {
  const auto outcome = solve(barrier(), 0.5);
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(outcome.x[0], 1.0, 1e-8);
  // Errors square exactly here: 1 - x_new = (1 - x)^2.
  ASSERT_GE(outcome.history.size(), 5U);
  for (std::size_t k = 2; k + 1 < outcome.history.size(); ++k) {
    const double ratio =
        outcome.history[k + 1].residual_n / std::pow(outcome.history[k].residual_n, 2);
    EXPECT_NEAR(ratio, 1.0, 0.2) << "iteration " << k;
  }
}

TEST(Newton, ShortensStepsToInadmissibleStates) {
  const auto outcome = solve(barrier(), 5.0);  // The full step goes to 5 - 20.
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(outcome.x[0], 1.0, 1e-8);
  EXPECT_LT(outcome.history[1].step_length, 0.3);
}

TEST(Newton, EnergyNeverIncreases) {
  // From 1.9 the full step is admissible, but increases the energy.
  for (const double start : {1.9, 40.0}) {
    const auto outcome = solve(barrier(), start);
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    EXPECT_LT(outcome.history[1].step_length, 1.0);
    for (std::size_t k = 1; k < outcome.history.size(); ++k)
      EXPECT_LE(outcome.history[k].energy_mj, outcome.history[k - 1].energy_mj + 1e-14);
  }
}

TEST(Newton, WithinTheRoundOffOfTheEnergyTheResidualMustDecrease) {
  // Full Newton steps for arctan diverge from beyond 1.39.
  const Scalar noisy([](double) { return 0.0; }, [](double x) { return 1e-16 * std::atan(x); },
                     [](double x) { return 1e-16 / (1.0 + x * x); });
  const auto outcome =
      solve(noisy, 3.0, {.relative_tolerance = 1e-25, .absolute_tolerance_n = 0.0});
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(outcome.x[0], 0.0, 1e-8);
  for (std::size_t k = 1; k < outcome.history.size(); ++k)
    EXPECT_LT(outcome.history[k].residual_n, outcome.history[k - 1].residual_n);
}

TEST(Newton, ShiftsAnIndefiniteTangentAndFindsAMinimum) {
  // Without a shift Newton would go from 0.3 to the maximum at 0.
  const auto outcome = solve(double_well(), 0.3);
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(outcome.x[0], 1.0, 1e-8);
  EXPECT_GT(outcome.history[1].diagonal_shift, 1.0);  // Curvature there is -0.73.
  EXPECT_EQ(outcome.history.back().diagonal_shift, 0.0);
}

/// A double well in x and a spring in y. The stabilized tangent differs in x only.
class WellAndSpring final : public NonlinearSystem {
 public:
  explicit WellAndSpring(double psd_curvature) : psd_curvature_(psd_curvature) {}

  std::optional<ResidualState> residual_state(const VectorX& x) const override {
    const double well = x[0] * x[0] - 1.0, spring = x[1] - 2.0;
    return ResidualState{.energy_mj = 0.25 * well * well + 50.0 * spring * spring,
                         .residual_n = Eigen::Vector2d(x[0] * well, 100.0 * spring),
                         .residual_reference_n = 1.0,
                         .energy_round_off_mj = 1e-13};
  }
  linear::SparseMatrix tangent(const VectorX& x, Tangent kind) const override {
    const double exact = 3.0 * x[0] * x[0] - 1.0;
    const double curvature = kind == Tangent::kExact ? exact : psd_curvature_;
    return sparse(Eigen::Vector2d(curvature, 100.0).asDiagonal());
  }

 private:
  double psd_curvature_;
};

TEST(Newton, PrefersTheStabilizedTangentToAShift) {
  linear::LinearSolver solver;
  const auto outcome = solve_newton(WellAndSpring(2.0), Eigen::Vector2d(0.3, 0.0), solver);
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(outcome.x[0], 1.0, 1e-6);
  EXPECT_NEAR(outcome.x[1], 2.0, 1e-12);
  EXPECT_EQ(outcome.history[1].tangent_blend, 0.5);  // Of -0.73 and 2: a quarter is not enough.
  for (const NewtonIterate& line : outcome.history) EXPECT_EQ(line.diagonal_shift, 0.0);
  EXPECT_EQ(outcome.history.back().tangent_blend, 0.0);
}

TEST(Newton, LeavesASaddleInFewStepsHoweverStiffTheStabilizedTangent) {
  // Without expansion a step multiplies x by 1.02 at most.
  linear::LinearSolver solver;
  const auto outcome = solve_newton(WellAndSpring(200.0), Eigen::Vector2d(1e-3, 2.0), solver);
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(outcome.x[0], 1.0, 1e-6);
  EXPECT_LE(outcome.iterations(), 12);
}

/// A nonlinear spring in the plane, |x|^2/2 + |x|^4/4, with a constant load and a force without a
/// potential, swirl * (-y, x).
class Swirl final : public NonlinearSystem {
 public:
  Swirl(double swirl, Eigen::Vector2d pull) : swirl_(swirl), pull_(std::move(pull)) {}

  std::optional<ResidualState> residual_state(const VectorX& x) const override {
    const double square = x.squaredNorm();
    const Eigen::Vector2d follower = swirl_ * Eigen::Vector2d(-x[1], x[0]);
    return ResidualState{.energy_mj = 0.5 * square + 0.25 * square * square - pull_.dot(x),
                         .residual_n = (1.0 + square) * x - pull_ + follower,
                         .follower_n = follower,
                         .residual_reference_n = 1.0,
                         .energy_round_off_mj = 1e-14};
  }
  linear::SparseMatrix tangent(const VectorX& x, Tangent) const override {
    return sparse((1.0 + x.squaredNorm()) * Eigen::Matrix2d::Identity() + 2.0 * x * x.transpose());
  }

 private:
  double swirl_;
  Eigen::Vector2d pull_;
};

TEST(Newton, ForcesWithoutAPotentialEnterTheEnergyByTheirWork) {
  linear::LinearSolver solver;
  for (const double pull : {1.0, 100.0}) {
    const auto outcome = solve_newton(Swirl(0.5, {pull, 0.0}), Eigen::Vector2d(0.0, 5.0), solver);
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    // pull = M x, where M rotates by atan(swirl / (1 + |x|^2)).
    const double stiffness = 1.0 + outcome.x.squaredNorm();
    EXPECT_NEAR(std::hypot(stiffness, 0.5) * outcome.x.norm(), pull, 1e-7 * pull);
    EXPECT_NEAR(std::atan2(outcome.x[1], outcome.x[0]), -std::atan2(0.5, stiffness), 1e-7);
    for (std::size_t k = 1; k < outcome.history.size(); ++k) {
      EXPECT_LE(outcome.history[k].energy_mj, outcome.history[k - 1].energy_mj + 1e-13);
    }
  }
}

TEST(Newton, ATooStrongFollowerDoesNotConverge) {
  linear::LinearSolver solver;
  const auto outcome = solve_newton(Swirl(20.0, {1.0, 0.0}), Eigen::Vector2d(0.0, 1.0), solver);
  EXPECT_FALSE(outcome.converged());
}

TEST(Newton, ShiftedStepsWithLittleProgressStagnate) {
  // The energy decreases up to x = 1, where states become inadmissible; each tangent needs a shift.
  const Scalar bounded([](double x) { return -x; }, [](double) { return -1.0; },
                       [](double) { return -1.0; }, [](double x) { return x < 1.0; });
  const auto outcome = solve(bounded, 0.0, {.max_iterations = 1000, .max_backtracks = 1000});
  EXPECT_EQ(outcome.stop, NewtonStop::kStagnated);
  EXPECT_NE(outcome.reason.find("no progress"), std::string::npos) << outcome.reason;
  EXPECT_LE(outcome.iterations(), 25);
}

TEST(Newton, AnEquilibriumAsStartNeedsNoIteration) {
  const auto outcome = solve(barrier(), 1.0);
  EXPECT_TRUE(outcome.converged());
  EXPECT_EQ(outcome.iterations(), 0);
  EXPECT_EQ(outcome.history.size(), 1U);
}

TEST(Newton, StopsAtMaxIterationsWithAMessage) {
  const auto outcome = solve(barrier(), 0.01, {.max_iterations = 2});
  EXPECT_EQ(outcome.stop, NewtonStop::kTooManyIterations);
  EXPECT_EQ(outcome.iterations(), 2);
  EXPECT_NE(outcome.reason.find("not converged after 2 iterations: |r| is"), std::string::npos)
      << outcome.reason;
  EXPECT_GT(outcome.x[0], 0.01);  // The last state is returned.
}

TEST(Newton, StopsWhereNoStepIsAcceptable) {
  // The slope has the wrong sign.
  const Scalar inconsistent([](double x) { return -x; }, [](double) { return 1.0; },
                            [](double) { return 1.0; });
  const auto outcome = solve(inconsistent, 0.0);
  EXPECT_EQ(outcome.stop, NewtonStop::kStagnated);
  EXPECT_TRUE(outcome.reason.starts_with("no step along the search direction reduces the energy"))
      << outcome.reason;
}

/// W = -x, admissible up to a wall.
class Walled final : public NonlinearSystem {
 public:
  explicit Walled(double wall) : wall_(wall) {}
  std::optional<ResidualState> residual_state(const VectorX& x) const override {
    if (x[0] > wall_) return std::nullopt;
    return ResidualState{.energy_mj = -x[0],
                         .residual_n = VectorX::Constant(1, -1.0),
                         .residual_reference_n = 1.0,
                         .energy_round_off_mj = 1e-15};
  }
  std::string inadmissible_cause(const VectorX& x) const override {
    return x[0] > wall_ ? "a wall stands there" : "";
  }
  linear::SparseMatrix tangent(const VectorX&, Tangent) const override {
    return sparse(Eigen::MatrixXd::Constant(1, 1, 1.0));
  }

 private:
  double wall_;
};

TEST(Newton, NamesTheCauseOfAnInadmissibleStepOrStart) {
  const auto stuck = solve(Walled(0.0), 0.0);
  EXPECT_EQ(stuck.stop, NewtonStop::kStagnated);
  EXPECT_TRUE(stuck.reason.starts_with(
      "no step along the search direction is acceptable, because a wall stands there"))
      << stuck.reason;
  const auto outside = solve(Walled(0.0), 0.5);
  EXPECT_EQ(outside.stop, NewtonStop::kInadmissibleStart);
  EXPECT_EQ(outside.reason, "the start is inadmissible: a wall stands there");
}

TEST(Newton, StopsAfterManyStepsWithoutProgress) {
  // The energy is within round-off, and |r| decreases very little.
  const Scalar slow([](double) { return 0.0; }, [](double x) { return 1e-9 * (1.0 + 1e-3 * x); },
                    [](double) { return 1e-9; });
  const auto outcome = solve(slow, 0.0,
                             {.relative_tolerance = 1e-12,
                              .absolute_tolerance_n = 0.0,
                              .max_iterations = 1000,
                              .stagnation_iterations = 5});
  EXPECT_EQ(outcome.stop, NewtonStop::kStagnated);
  EXPECT_NE(outcome.reason.find("no progress for 5 iterations"), std::string::npos)
      << outcome.reason;
}

TEST(Newton, StopsAtATangentThatNoShiftHelps) {
  const Scalar flat([](double x) { return x; }, [](double) { return 1.0; },
                    [](double) { return 0.0; });
  EXPECT_EQ(solve(flat, 0.0).stop, NewtonStop::kSingularTangent);
  const Scalar broken([](double x) { return x; }, [](double) { return 1.0; },
                      [](double) { return std::numeric_limits<double>::quiet_NaN(); });
  EXPECT_EQ(solve(broken, 0.0).stop, NewtonStop::kSingularTangent);
}

TEST(Newton, NaNNeverConverges) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solve(barrier(), kNan).stop, NewtonStop::kInadmissibleStart);
  EXPECT_EQ(solve(barrier(), -1.0).stop, NewtonStop::kInadmissibleStart);
  const Scalar nan_force([](double) { return 0.0; }, [](double) { return kNan; },
                         [](double) { return 1.0; });
  EXPECT_EQ(solve(nan_force, 0.0).stop, NewtonStop::kInadmissibleStart);
  const Scalar nan_energy([](double) { return kNan; }, [](double) { return 0.0; },
                          [](double) { return 1.0; });
  EXPECT_EQ(solve(nan_energy, 0.0).stop, NewtonStop::kInadmissibleStart);
  // NaN everywhere except at the start: no step is accepted.
  const Scalar island([](double x) { return x == 0.0 ? 0.0 : kNan; }, [](double) { return 1.0; },
                      [](double) { return 1.0; });
  const auto outcome = solve(island, 0.0);
  EXPECT_EQ(outcome.stop, NewtonStop::kStagnated);
  EXPECT_EQ(outcome.x[0], 0.0);
}

class StopAfter final : public Progress {
 public:
  explicit StopAfter(int calls) : left_(calls) {}
  bool stop_requested() const override { return left_-- <= 0; }

 private:
  mutable int left_;
};

TEST(Newton, LackOfMemoryIsReported) {
  linear::LinearSolver solver(test::little_memory());
  const auto outcome = solve_newton(barrier(), VectorX::Constant(1, 0.5), solver);
  EXPECT_EQ(outcome.stop, NewtonStop::kOutOfMemory);
  EXPECT_NE(outcome.reason.find("out of memory after 0 iterations"), std::string::npos)
      << outcome.reason;
}

TEST(Newton, StopsOnRequest) {
  StopAfter at_once(0);
  const auto first = solve(barrier(), 0.5, {}, at_once);
  EXPECT_EQ(first.stop, NewtonStop::kCancelled);
  EXPECT_EQ(first.iterations(), 0);
  StopAfter later(3);
  EXPECT_EQ(solve(barrier(), 0.5, {}, later).stop, NewtonStop::kCancelled);
}

TEST(Newton, NamesTheOptionThatIsOutOfRange) {
  const auto message_of = [](const NewtonOptions& options) {
    const auto result = validate(options);
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    return result.error().message;
  };
  EXPECT_TRUE(validate(NewtonOptions{}).has_value());
  EXPECT_EQ(message_of({.relative_tolerance = -1e-8}),
            "newton: relative_tolerance is -1e-08, must be in [0, 1)");
  EXPECT_NE(message_of({.relative_tolerance = std::nan("")}).find("is nan"), std::string::npos);
  EXPECT_NE(message_of({.absolute_tolerance_n = -1.0}).find("absolute"), std::string::npos);
  EXPECT_NE(message_of({.max_iterations = 0}).find("max_iterations"), std::string::npos);
  EXPECT_NE(message_of({.max_backtracks = -1}).find("max_backtracks"), std::string::npos);
  EXPECT_NE(message_of({.sufficient_decrease = 0.5}).find("sufficient"), std::string::npos);
  EXPECT_NE(message_of({.stagnation_iterations = 0}).find("stagnation"), std::string::npos);
  EXPECT_NE(message_of({.max_linear_tolerance = 1.0}).find("max_linear"), std::string::npos);
  EXPECT_NE(message_of({.min_linear_tolerance = 0.1}).find("min_linear"), std::string::npos);
  EXPECT_NE(message_of({.max_diagonal_shift = -1.0}).find("max_diagonal"), std::string::npos);
  EXPECT_THROW((void)solve(barrier(), 0.5, {.max_iterations = 0}), LogicError);
}

}  // namespace
}  // namespace lefort::fem::test_newton
