#include <lefort/core/check.h>
#include <lefort/fem/solve/line_search.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/fem/solve/newton_constants.h>
#include <lefort/fem/solve/newton_convergence.h>
#include <lefort/fem/solve/search_direction.h>

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

namespace lefort::fem {
namespace internal {
namespace {

const char* message_of(NewtonStop no_direction) {
  switch (no_direction) {
    case NewtonStop::kOutOfMemory:
      return "out of memory";
    case NewtonStop::kLinearNotConverged:
      return "linear iterations not converged";
    case NewtonStop::kCancelled:
      return "cancelled";
    default:
      return "tangent not positive definite";
  }
}

/// The iterations from one start.
class NewtonIteration {
 public:
  NewtonIteration(const NonlinearSystem& system, linear::LinearSolver& linear_solver,
                  const NewtonOptions& options, const Progress& progress, NewtonState start)
      : system_(system),
        options_(options),
        progress_(progress),
        at_(std::move(start)),
        directions_(system, linear_solver, options, progress),
        linear_tolerance_(options),
        stagnation_(at_) {}

  /// Call once.
  NewtonOutcome run() {
    record(0.0);
    std::optional<End> end;
    while (!end) end = iterate();
    outcome_.stop = end->stop;
    outcome_.reason =
        fmt::format("{} after {} iterations: |r| is {:.3e} N, must be <= {:.3e} N", end->message,
                    outcome_.iterations(), at_.residual_n, tolerance_n(at_, options_));
    outcome_.x = std::move(at_.x);
    enter(SolvePhase::kNone, options_);
    return std::move(outcome_);
  }

 private:
  struct End {
    NewtonStop stop;
    std::string message;
  };

  [[nodiscard]] bool has_converged() const {
    return is_converged(at_, outcome_.iterations(), options_);
  }

  /// \returns nothing if another iteration is needed.
  std::optional<End> iterate() {
    if (has_converged()) return End{NewtonStop::kConverged, "converged"};
    if (outcome_.iterations() == options_.max_iterations)
      return End{NewtonStop::kTooManyIterations, "not converged"};
    const double tolerance = linear_tolerance_.next(at_.residual_n, tolerance_n(at_, options_));
    const auto direction = directions_.find(at_, model_, tolerance);
    if (progress_.stop_requested()) return End{NewtonStop::kCancelled, "cancelled"};
    if (!direction) return End{direction.error(), message_of(direction.error())};
    model_ = direction->model;
    std::optional<Step> step = find_step(*direction);
    if (!step && is_round_off(at_, options_)) return End{NewtonStop::kConverged, "converged"};
    if (!step) return End{NewtonStop::kStagnated, cause_of_stagnation(direction->dx)};

    const int stalled = stagnation_.stalled_steps(at_, step->to, model_.diagonal_shift > 0.0);
    at_ = std::move(step->to);
    record(step->length);
    if (stalled >= options_.stagnation_iterations && !has_converged())
      return End{NewtonStop::kStagnated, fmt::format("no progress for {} iterations", stalled)};
    return std::nullopt;
  }

  /// Why no step along `dx` was acceptable: what limits the shortest and the full step.
  [[nodiscard]] std::string cause_of_stagnation(const VectorX& dx) const {
    const double shortest = std::pow(kMinContraction, options_.max_backtracks);
    for (const double length : {shortest, 1.0})
      if (const std::string cause = system_.inadmissible_cause(at_.x + length * dx); !cause.empty())
        return fmt::format("no step along the search direction is acceptable, because {}", cause);
    return "no step along the search direction reduces the energy";
  }

  std::optional<Step> find_step(const SearchDirection& direction) {
    std::optional<Step> step;
    if (direction.unsymmetric_dx)
      step = backtrack_nonsymmetric(system_, at_, *direction.unsymmetric_dx, options_);
    const bool is_unsymmetric_step = step.has_value();
    if (!step) step = backtrack(system_, at_, direction.dx, options_);
    if (!step) return std::nullopt;
    model_.is_step_short = step->length < kShortStep;
    if (model_.tangent_blend > 0.0 && step->length == 1.0 && !is_unsymmetric_step)
      return expand_step(system_, at_, direction.dx, *std::move(step), options_);
    return step;
  }

  /// Adds a line to the history.
  void record(double step_length) {
    outcome_.history.push_back({.residual_n = at_.residual_n,
                                .residual_reference_n = at_.residual_state.residual_reference_n,
                                .energy_mj = at_.energy_mj,
                                .step_length = step_length,
                                .tangent_blend = model_.tangent_blend,
                                .diagonal_shift = model_.diagonal_shift,
                                .contacts = at_.residual_state.contacts});
    if (options_.on_iterate) options_.on_iterate(outcome_.history.back(), at_.residual_state);
  }

  const NonlinearSystem& system_;
  const NewtonOptions& options_;
  const Progress& progress_;
  NewtonState at_;
  TangentModel model_;
  DirectionFinder directions_;
  EisenstatWalkerTolerance linear_tolerance_;
  StagnationMonitor stagnation_;
  NewtonOutcome outcome_;
};

}  // namespace
}  // namespace internal

Result<void> validate(const NewtonOptions& options) {
  const auto out_of_range = [](const char* what, auto value, const char* range) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("newton: {} is {}, must be {}", what, value, range));
  };
  if (!(options.relative_tolerance >= 0.0 && options.relative_tolerance < 1.0))
    return out_of_range("relative_tolerance", options.relative_tolerance, "in [0, 1)");
  if (!(options.absolute_tolerance_n >= 0.0))
    return out_of_range("absolute_tolerance_n", options.absolute_tolerance_n, ">= 0 N");
  if (options.max_iterations < 1)
    return out_of_range("max_iterations", options.max_iterations, ">= 1");
  if (options.max_backtracks < 0)
    return out_of_range("max_backtracks", options.max_backtracks, ">= 0");
  if (!(options.sufficient_decrease > 0.0 && options.sufficient_decrease < 0.5))
    return out_of_range("sufficient_decrease", options.sufficient_decrease, "in (0, 0.5)");
  if (options.stagnation_iterations < 1)
    return out_of_range("stagnation_iterations", options.stagnation_iterations, ">= 1");
  if (!(options.max_linear_tolerance > 0.0 && options.max_linear_tolerance < 1.0))
    return out_of_range("max_linear_tolerance", options.max_linear_tolerance, "in (0, 1)");
  if (!(options.min_linear_tolerance > 0.0 &&
        options.min_linear_tolerance <= options.max_linear_tolerance))
    return out_of_range("min_linear_tolerance", options.min_linear_tolerance,
                        "in (0, max_linear_tolerance]");
  if (!(options.max_diagonal_shift >= 0.0))
    return out_of_range("max_diagonal_shift", options.max_diagonal_shift, ">= 0");
  return {};
}

NewtonOutcome solve_newton(const NonlinearSystem& system, VectorX start,
                           linear::LinearSolver& linear_solver, const NewtonOptions& options,
                           Progress& progress) {
  LEFORT_CHECK(validate(options).has_value());
  LEFORT_CHECK(options.round_off_n.size() == 0 || options.round_off_n.size() == start.size());
  enter(SolvePhase::kAssembly, options);
  std::optional<internal::NewtonState> first = internal::evaluate_state(system, start);
  if (!first) {
    enter(SolvePhase::kNone, options);
    NewtonOutcome outcome;
    const std::string cause = system.inadmissible_cause(start);
    outcome.x = std::move(start);
    outcome.reason = fmt::format("the start is inadmissible: {}",
                                 cause.empty() ? "a force is not finite" : cause);
    return outcome;
  }
  return internal::NewtonIteration(system, linear_solver, options, progress, *std::move(first))
      .run();
}

}  // namespace lefort::fem
