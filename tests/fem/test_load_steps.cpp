#include <lefort/core/check.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/fem/solve/load_steps.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "fem/body.h"
#include "support/box_mesh.h"

namespace lefort::fem::test_load_steps {
namespace {

LoadState rest() { return {.t = 0.0, .u = VectorX::Zero(1)}; }

/// Finds u = t^2; fails if the guess is further than `max_distance` from it.
SolveAtLoad parabola(double max_distance, int iterations = 3) {
  return [=](double t, const VectorX& start) {
    NewtonOutcome outcome;
    outcome.history.resize(std::size_t(iterations) + 1);
    const bool found = std::abs(start[0] - t * t) <= max_distance;
    outcome.stop = found ? NewtonStop::kConverged : NewtonStop::kTooManyIterations;
    outcome.reason = found ? "converged" : "too far away";
    outcome.x = VectorX::Constant(1, found ? t * t : -99.0);
    return outcome;
  };
}

/// Converges up to t = `limit`.
SolveAtLoad converging_up_to(double limit) {
  return [=](double t, const VectorX&) {
    NewtonOutcome outcome;
    outcome.stop = t <= limit ? NewtonStop::kConverged : NewtonStop::kStagnated;
    outcome.reason = "beyond the limit";
    outcome.x = VectorX::Constant(1, t);
    return outcome;
  };
}

TEST(LoadSteps, AnEasyLoadTakesOneStep) {
  LoadStepper stepper(rest(), parabola(10.0));
  ASSERT_TRUE(stepper.advance_to(1.0).has_value());
  EXPECT_EQ(stepper.state().t, 1.0);
  EXPECT_EQ(stepper.state().u[0], 1.0);
  ASSERT_EQ(stepper.attempts().size(), 1U);
  EXPECT_FALSE(stepper.attempts()[0].extrapolated);
  EXPECT_EQ(stepper.attempts()[0].reason, "converged");
}

TEST(LoadSteps, AFailedIncrementIsHalvedAndLeavesNoTrace) {
  LoadStepper stepper(rest(), parabola(0.1), {.growth_factor = 1.0});
  ASSERT_TRUE(stepper.advance_to(1.0).has_value());
  const auto& attempts = stepper.attempts();
  EXPECT_EQ(attempts[0].t_to, 1.0);
  EXPECT_EQ(attempts[0].stop, NewtonStop::kTooManyIterations);
  EXPECT_EQ(attempts[1].t_to, 0.5);   // 0.25 away: still too far.
  EXPECT_EQ(attempts[2].t_to, 0.25);  // 0.0625 away.
  EXPECT_EQ(attempts[2].stop, NewtonStop::kConverged);
  EXPECT_EQ(stepper.state().u[0], 1.0);
}

TEST(LoadSteps, LaterIncrementsStartFromAnExtrapolation) {
  // After an increment h from t the error of the extrapolation is 2 h^2, of the last state 2 t h +
  // h^2.
  LoadStepper stepper(rest(), parabola(0.13), {.first_increment = 0.25, .growth_factor = 1.0});
  ASSERT_TRUE(stepper.advance_to(2.0).has_value());
  EXPECT_EQ(stepper.attempts().size(), 8U);
  for (std::size_t k = 1; k < 8; ++k) EXPECT_TRUE(stepper.attempts()[k].extrapolated);
}

TEST(LoadSteps, WhereTheExtrapolationFailsTheLastStateIsTheGuess) {
  // u = 1 beyond t = 1: the extrapolation leads away from it, the last state is exact.
  const SolveAtLoad solve = [](double t, const VectorX& start) {
    const double wanted = std::min(t, 1.0);
    NewtonOutcome outcome;
    outcome.stop =
        std::abs(start[0] - wanted) < 0.6 ? NewtonStop::kConverged : NewtonStop::kInadmissibleStart;
    outcome.x = VectorX::Constant(1, wanted);
    outcome.history.resize(2);
    return outcome;
  };
  LoadStepper stepper(rest(), solve, {.first_increment = 0.5});
  ASSERT_TRUE(stepper.advance_to(0.5).has_value());
  ASSERT_TRUE(stepper.advance_to(1.0).has_value());
  ASSERT_TRUE(stepper.advance_to(2.0).has_value());
  const auto& attempts = stepper.attempts();
  ASSERT_EQ(attempts.size(), 4U);
  EXPECT_TRUE(attempts[2].extrapolated);
  EXPECT_EQ(attempts[2].stop, NewtonStop::kInadmissibleStart);
  EXPECT_FALSE(attempts[3].extrapolated);
  EXPECT_EQ(attempts[3].t_to, 2.0);
}

TEST(LoadSteps, IncrementsGrowOnlyWhenEasy) {
  const LoadStepOptions options{
      .first_increment = 0.125, .growth_factor = 2.0, .target_iterations = 3};
  LoadStepper easy(rest(), parabola(100.0, 3), options);
  ASSERT_TRUE(easy.advance_to(1.0).has_value());
  ASSERT_EQ(easy.attempts().size(), 4U);  // 1/8, 2/8, 4/8, the rest.
  EXPECT_EQ(easy.attempts()[2].t_to, 0.875);
  LoadStepper hard(rest(), parabola(100.0, 4), options);
  ASSERT_TRUE(hard.advance_to(1.0).has_value());
  EXPECT_EQ(hard.attempts().size(), 8U);
}

TEST(LoadSteps, IncrementsStayBelowTheMax) {
  LoadStepper stepper(rest(), parabola(100.0),
                      {.first_increment = 0.125, .max_increment = 0.25, .growth_factor = 2.0});
  ASSERT_TRUE(stepper.advance_to(1.0).has_value());
  ASSERT_EQ(stepper.attempts().size(), 5U);  // 1/8, 2/8, 2/8, 2/8, the rest.
  EXPECT_EQ(stepper.attempts()[3].t_to, 0.875);
}

TEST(LoadSteps, ATinyIncrementBeforeALevelDoesNotGrowAndIsNotExtrapolatedFar) {
  std::vector<double> starts;
  const auto solve = [&](double t, const VectorX& start) {
    starts.push_back(start[0]);
    NewtonOutcome outcome;
    outcome.history.resize(1);
    outcome.stop = NewtonStop::kConverged;
    outcome.x = VectorX::Constant(1, t < 0.2 ? t : t + 1e-3);  // The error of the last equilibrium.
    return outcome;
  };
  LoadStepper stepper(rest(), solve,
                      {.first_increment = 0.2, .min_increment = 1e-6, .growth_factor = 2});
  ASSERT_TRUE(stepper.advance_to(0.2 - 1e-6).has_value());
  ASSERT_TRUE(stepper.advance_to(0.2).has_value());
  ASSERT_TRUE(stepper.advance_to(1.0).has_value());
  EXPECT_LT(stepper.attempts()[2].t_to, 0.2 + 0.4 + 1e-9);
  EXPECT_LT(std::abs(starts[2] - 0.2), 0.02);
}

TEST(LoadSteps, EveryConvergedStateIsReportedAndAnErrorThereEndsThePath) {
  std::vector<double> reported;
  const OnLoadState notify = [&](const LoadState& state) -> Result<void> {
    reported.push_back(state.t);
    if (reported.size() == 2) return fail(ErrorCode::kFileUnwritable, "the disk is full");
    return {};
  };
  LoadStepper stepper(rest(), parabola(0.13), {.growth_factor = 1.0});
  const auto walked = stepper.advance_to(1.0, Progress::none(), notify);
  ASSERT_FALSE(walked);
  EXPECT_EQ(walked.error().message, "the disk is full");
  EXPECT_EQ(reported, (std::vector<double>{0.25, 0.5}));
  EXPECT_EQ(stepper.state().t, 0.5);
  EXPECT_EQ(stepper.attempts().back().t_to, 0.5);
}

TEST(LoadSteps, RoundOffLeavesNoTinyLastIncrement) {
  LoadStepper stepper(rest(), parabola(100.0), {.first_increment = 0.1, .growth_factor = 1.0});
  ASSERT_TRUE(stepper.advance_to(1.0).has_value());
  EXPECT_EQ(stepper.attempts().size(), 10U);
  EXPECT_EQ(stepper.state().t, 1.0);
}

TEST(LoadSteps, FailsAtTheMinIncrementAndKeepsTheLastState) {
  LoadStepper stepper(rest(), converging_up_to(0.6), {.min_increment = 1.0 / 16});
  const auto result = stepper.advance_to(1.0);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kNotConverged);
  EXPECT_EQ(result.error().message,
            "no equilibrium from load level 0.5625 to 0.625, the smallest increment: beyond the "
            "limit");
  EXPECT_EQ(stepper.state().t, 0.5625);
  EXPECT_EQ(stepper.state().u[0], 0.5625);
  EXPECT_FALSE(stepper.advance_to(1.0).has_value());  // A second call fails, too.
}

TEST(LoadSteps, FailsAfterFewAttemptsForAnyLimit) {
  // Twelfths are not binary fractions: a difference of levels differs from the increment by
  // rounding.
  for (int k = 0; k < 12; ++k) {
    LoadStepper stepper(rest(), converging_up_to(k / 12.0 + 1e-12),
                        {.first_increment = 1.0 / 12, .min_increment = 1.0 / 24});
    ErrorCode code = ErrorCode::kCancelled;
    for (int level = 1; level <= 12; ++level) {
      const auto result = stepper.advance_to(level / 12.0);
      if (result) continue;
      code = result.error().code;
      break;
    }
    EXPECT_EQ(code, ErrorCode::kNotConverged) << "limit at " << k << "/12";
    EXPECT_NEAR(stepper.state().t, k / 12.0, 1e-9);
    // k levels, a failed twelfth, a failed half of it, each from at most two starts.
    EXPECT_LE(stepper.attempts().size(), std::size_t(k) + 4) << "limit at " << k << "/12";
  }
}

TEST(LoadSteps, MakesAtMostMaxAttempts) {
  LoadStepper stepper(rest(), parabola(1e-3), {.growth_factor = 1.0, .max_attempts = 7});
  const auto result = stepper.advance_to(1.0);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kNotConverged);
  EXPECT_NE(result.error().message.find("7 attempts: too far away"), std::string::npos)
      << result.error().message;
  EXPECT_EQ(stepper.attempts().size(), 7U);
}

TEST(LoadSteps, OneHardIncrementDoesNotShortenThoseOfLaterLevels) {
  // Between 0.4 and 0.6 an increment of at most 1/16 converges.
  const SolveAtLoad hard_middle = [at = 0.0](double t, const VectorX& start) mutable {
    NewtonOutcome outcome;
    const bool hard = t > 0.4 && at < 0.6 && t - at > 1.0 / 16 + 1e-9;
    outcome.stop = hard ? NewtonStop::kTooManyIterations : NewtonStop::kConverged;
    outcome.history.resize(30);  // Never easy.
    outcome.x = start;
    if (!hard) at = t;
    return outcome;
  };
  LoadStepper stepper(rest(), hard_middle, {.first_increment = 0.25});
  for (const double level : {0.25, 0.5, 0.75}) ASSERT_TRUE(stepper.advance_to(level).has_value());
  const std::size_t before = stepper.attempts().size();
  ASSERT_TRUE(stepper.advance_to(1.0).has_value());
  EXPECT_EQ(stepper.attempts().size(), before + 1);
}

TEST(LoadSteps, AGuessThatDidNotCauseTheFailureIsNotReplaced) {
  const auto starts_tried = [](NewtonStop stop, int iterations) {
    LoadStepper stepper(rest(),
                        [=](double t, const VectorX& start) {
                          NewtonOutcome outcome;
                          outcome.stop = t <= 1.0 ? NewtonStop::kConverged : stop;
                          outcome.history.resize(std::size_t(iterations) + 1);
                          outcome.x = start;
                          return outcome;
                        },
                        {.min_increment = 1.0});
    EXPECT_TRUE(stepper.advance_to(1.0).has_value());
    EXPECT_FALSE(stepper.advance_to(2.0).has_value());
    return stepper.attempts().size() - 1;
  };
  EXPECT_EQ(starts_tried(NewtonStop::kInadmissibleStart, 0), 2U);
  EXPECT_EQ(starts_tried(NewtonStop::kRejected, 20), 2U);
  EXPECT_EQ(starts_tried(NewtonStop::kStagnated, 3), 2U);
  EXPECT_EQ(starts_tried(NewtonStop::kStagnated, 20), 1U);
  EXPECT_EQ(starts_tried(NewtonStop::kTooManyIterations, 30), 1U);
}

TEST(LoadSteps, LackOfMemoryIsNotRetriedInSmallerIncrements) {
  LoadStepper stepper(rest(), [](double, const VectorX& start) {
    NewtonOutcome outcome;
    outcome.stop = NewtonStop::kOutOfMemory;
    outcome.reason = "out of memory";
    outcome.x = start;
    return outcome;
  });
  EXPECT_EQ(stepper.advance_to(1.0).error().code, ErrorCode::kOutOfMemory);
  EXPECT_EQ(stepper.attempts().size(), 1U);
}

TEST(LoadSteps, RejectsALevelThatIsNotGreater) {
  LoadStepper stepper(rest(), parabola(10.0));
  for (const double t : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_EQ(stepper.advance_to(t).error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(stepper.attempts().empty());
}

class Stop final : public Progress {
 public:
  bool stop_requested() const override { return true; }
};

TEST(LoadSteps, StopsOnRequest) {
  Stop stop;
  LoadStepper stepper(rest(), parabola(10.0));
  EXPECT_EQ(stepper.advance_to(1.0, stop).error().code, ErrorCode::kCancelled);
  EXPECT_TRUE(stepper.attempts().empty());
  LoadStepper cancelled_inside(rest(), [](double, const VectorX& start) {
    NewtonOutcome outcome;
    outcome.stop = NewtonStop::kCancelled;
    outcome.x = start;
    return outcome;
  });
  EXPECT_EQ(cancelled_inside.advance_to(1.0).error().code, ErrorCode::kCancelled);
  EXPECT_EQ(cancelled_inside.attempts().size(), 1U);
  EXPECT_EQ(cancelled_inside.state().t, 0.0);
}

TEST(LoadSteps, NamesTheOptionThatIsOutOfRange) {
  const auto message_of = [](const LoadStepOptions& options) {
    return validate(options).error().message;
  };
  EXPECT_TRUE(validate(LoadStepOptions{}).has_value());
  EXPECT_EQ(message_of({.first_increment = 0.0}), "load steps: first_increment is 0, must be > 0");
  EXPECT_NE(message_of({.min_increment = 0.0}).find("min_increment"), std::string::npos);
  EXPECT_NE(message_of({.min_increment = 2.0}).find("min_increment"), std::string::npos);
  EXPECT_NE(message_of({.max_increment = 0.5}).find("max_increment"), std::string::npos);
  EXPECT_NE(message_of({.growth_factor = 0.9}).find("growth"), std::string::npos);
  EXPECT_NE(message_of({.target_iterations = -1}).find("target_iterations"), std::string::npos);
  EXPECT_NE(message_of({.max_attempts = 0}).find("max_attempts"), std::string::npos);
  EXPECT_THROW(LoadStepper(rest(), parabola(1.0), {.growth_factor = 0.0}), LogicError);
}

TEST(LoadSteps, TheTwistOfABlockIsHalvedUntilNoElementInverts) {
  // Rotated by 2.6 rad: the linear response contracts the middle to a line.
  auto mesh = test::box_mesh({.cells = {3, 3, 6}, .size_mm = {10, 10, 20}, .distortion = 0.15});
  const auto at = [&](double t) {
    RigidTransform turn = RigidTransform::Identity();
    turn.translate(Vec3(5, 5, 0)).rotate(Eigen::AngleAxisd(2.6 * t, Vec3::UnitZ()));
    turn.translate(Vec3(-5, -5, 0));
    return test::joined({prescribe_zero(mesh.node_sets.at("z0")),
                         prescribe_rigid_motion(mesh.node_sets.at("z1"), mesh.nodes_L, turn)});
  };
  const test::Body body(mesh, {{0, NeoHookean{.mu_mpa = 0.5, .lambda_mpa = 2.0}}}, at(1.0));
  linear::LinearSolver solver;
  LoadStepper stepper({.t = 0.0, .u = body.at_rest()}, [&](double t, const VectorX& start) {
    return find_equilibrium(body.assembler, at(t), start, solver);
  });
  const auto result = stepper.advance_to(1.0);
  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_EQ(stepper.attempts()[0].stop, NewtonStop::kInadmissibleStart);
  EXPECT_EQ(stepper.attempts()[1].t_to, 0.5);
  EXPECT_EQ(stepper.state().t, 1.0);
  EXPECT_TRUE(body.assembler.forces(stepper.state().u).has_value());
  for (const auto& p : at(1.0))
    EXPECT_EQ(stepper.state().u[3 * Index(p.node) + p.component], p.displacement_mm);
}

TEST(LoadStepper, ResumesFromItsCheckpointWithTheSameResults) {
  std::vector<double> requested;
  const SolveAtLoad solve = [&](double t, const VectorX& start) {
    requested.push_back(t);
    requested.push_back(start[0]);
    NewtonOutcome outcome;
    outcome.stop = NewtonStop::kConverged;
    outcome.x = VectorX::Constant(1, t * t);
    outcome.history.resize(requested.size() % 3 == 0 ? 9 : 2);  // Some are easy.
    return outcome;
  };
  const LoadStepOptions options{.first_increment = 0.05, .max_increment = 0.4};
  LoadStepper whole({0.0, VectorX::Zero(1)}, solve, options);
  ASSERT_TRUE(whole.advance_to(0.5));
  const LoadStepper::Checkpoint checkpoint = whole.checkpoint();
  requested.clear();
  ASSERT_TRUE(whole.advance_to(1.0));
  const std::vector<double> without_stop = std::exchange(requested, {});
  LoadStepper other = LoadStepper::resumed(checkpoint, solve, options);
  EXPECT_EQ(other.state().t, 0.5);
  ASSERT_TRUE(other.advance_to(1.0));
  EXPECT_EQ(requested, without_stop);
}

}  // namespace
}  // namespace lefort::fem::test_load_steps
