#include <lefort/core/check.h>
#include <lefort/fem/solve/load_steps.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lefort::fem {
namespace {

/// Relative rounding of load levels and increments.
constexpr double kRounding = 1e-9;

/// An increment shorter than this fraction of the planned one was cut off by a load level; its
/// iterations say nothing about a whole increment.
constexpr double kCutOffFraction = 0.1;

/// Max ratio of extrapolation: after an increment that was cut short, a larger ratio would amplify
/// the error of the last equilibrium.
constexpr double kMaxExtrapolation = 10.0;

/// \returns whether a failure may be due to the extrapolated guess. A solve of many iterations is
///   far from its guess; the last state as guess would not help.
bool may_be_due_to_guess(const NewtonOutcome& outcome, const LoadStepOptions& options) {
  return outcome.stop == NewtonStop::kInadmissibleStart || outcome.stop == NewtonStop::kRejected ||
         (outcome.stop == NewtonStop::kStagnated &&
          outcome.iterations() <= options.target_iterations);
}

}  // namespace

Result<void> validate(const LoadStepOptions& options) {
  const auto out_of_range = [](const char* what, auto value, const char* range) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("load steps: {} is {}, must be {}", what, value, range));
  };
  if (!(options.first_increment > 0.0) || !std::isfinite(options.first_increment))
    return out_of_range("first_increment", options.first_increment, "> 0");
  if (!(options.min_increment > 0.0 && options.min_increment <= options.first_increment))
    return out_of_range("min_increment", options.min_increment, "> 0 and <= first_increment");
  if (!(options.max_increment >= options.first_increment))
    return out_of_range("max_increment", options.max_increment, ">= first_increment");
  if (!(options.growth_factor >= 1.0) || !std::isfinite(options.growth_factor))
    return out_of_range("growth_factor", options.growth_factor, ">= 1");
  if (options.target_iterations < 0)
    return out_of_range("target_iterations", options.target_iterations, ">= 0");
  if (options.max_attempts < 1) return out_of_range("max_attempts", options.max_attempts, ">= 1");
  return {};
}

LoadStepper::LoadStepper(LoadState start, SolveAtLoad solve, const LoadStepOptions& options)
    : last_(std::move(start)),
      solve_(std::move(solve)),
      options_(options),
      increment_(options.first_increment) {
  LEFORT_CHECK(solve_ != nullptr);
  LEFORT_CHECK(validate(options).has_value());
}

LoadStepper LoadStepper::resumed(Checkpoint checkpoint, SolveAtLoad solve,
                                 const LoadStepOptions& options) {
  LoadStepper stepper(std::move(checkpoint.last), std::move(solve), options);
  stepper.before_last_ = std::move(checkpoint.before_last);
  stepper.increment_ = checkpoint.increment;
  return stepper;
}

VectorX LoadStepper::extrapolated(double t) const {
  const double ratio = std::min((t - last_.t) / (last_.t - before_last_->t), kMaxExtrapolation);
  return last_.u + ratio * (last_.u - before_last_->u);
}

NewtonOutcome LoadStepper::attempt(double t, bool extrapolate) {
  NewtonOutcome outcome = solve_(t, extrapolate ? extrapolated(t) : last_.u);
  attempts_.push_back({.t_from = last_.t,
                       .t_to = t,
                       .extrapolated = extrapolate,
                       .stop = outcome.stop,
                       .reason = outcome.reason,
                       .history = outcome.history});
  return outcome;
}

Result<void> LoadStepper::advance_to(double t_end, Progress& progress,
                                     const OnLoadState& on_state) {
  if (!std::isfinite(t_end) || !(t_end > last_.t))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("load level {} is not greater than {}", t_end, last_.t));
  const auto cancelled = [&] {
    return fail(ErrorCode::kCancelled, fmt::format("cancelled at load level {:.6g}", last_.t));
  };

  const auto not_converged = [&](double t, const char* why, const std::string& reason) {
    return fail(ErrorCode::kNotConverged,
                fmt::format("no equilibrium from load level {:.6g} to {:.6g}, {}: {}", last_.t, t,
                            why, reason));
  };

  increment_ = std::max(increment_, options_.first_increment);
  const std::size_t attempts_allowed = attempts_.size() + std::size_t(options_.max_attempts);
  while (last_.t < t_end) {
    if (progress.stop_requested()) return cancelled();
    // A remainder within rounding is included in the increment.
    const bool is_last = last_.t + (1.0 + kRounding) * increment_ >= t_end;
    const double t = is_last ? t_end : last_.t + increment_;
    // Not t - last_.t, which has the rounding of both levels.
    const double requested = is_last ? std::min(increment_, t_end - last_.t) : increment_;

    NewtonOutcome outcome = attempt(t, before_last_.has_value());
    if (before_last_ && may_be_due_to_guess(outcome, options_)) outcome = attempt(t, false);
    if (outcome.stop == NewtonStop::kCancelled) return cancelled();
    if (outcome.stop == NewtonStop::kOutOfMemory)
      return fail(ErrorCode::kOutOfMemory, outcome.reason);

    if (outcome.converged()) {
      before_last_ = std::exchange(last_, {t, std::move(outcome.x)});
      if (outcome.iterations() <= options_.target_iterations &&
          requested >= kCutOffFraction * increment_)
        increment_ = std::min(std::max(increment_, requested) * options_.growth_factor,
                              options_.max_increment);
      if (on_state) LEFORT_TRY_VOID(on_state(last_));
    } else if (requested <= (1.0 + kRounding) * options_.min_increment) {
      return not_converged(t, "the smallest increment", outcome.reason);
    } else {
      increment_ = std::max(0.5 * requested, options_.min_increment);
    }
    if (last_.t < t_end && attempts_.size() >= attempts_allowed)
      return not_converged(t_end, fmt::format("{} attempts", options_.max_attempts).c_str(),
                           outcome.reason);
  }
  return {};
}

}  // namespace lefort::fem
