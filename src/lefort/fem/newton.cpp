#include <lefort/core/check.h>
#include <lefort/fem/newton.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lefort::fem {
namespace {

/// The first shift tried on an indefinite tangent, the factor to the next, and the last, all as a
/// share of its mean diagonal: beyond the last the matrix is not a stiffness any more.
constexpr double kFirstShift = 1e-3;
constexpr double kShiftGrowth = 4.0;
constexpr double kLastShift = 1e3;

/// How much a step is shortened at least and at most.
constexpr double kShortenLeast = 0.5;
constexpr double kShortenMost = 0.1;

/// An admissible state and what is known there.
struct Iterate {
  VectorX x;
  Balance balance;
  double residual_n = 0.0;
};

std::optional<Iterate> iterate_at(const NonlinearSystem& system, VectorX x) {
  if (!x.allFinite()) return std::nullopt;
  std::optional<Balance> balance = system.balance(x);
  if (!balance) return std::nullopt;
  const double residual_n = balance->residual_n.norm();
  if (!std::isfinite(residual_n) || !std::isfinite(balance->energy_mj)) return std::nullopt;
  return Iterate{std::move(x), *std::move(balance), residual_n};
}

/// Factorises K + tau d I with the smallest tau tried that makes it positive definite.
///
/// \param last  the shift of the step before.
/// \returns tau, or nothing if there is none; or if told to stop.
std::optional<double> factorise_shifted(const SparseMatrix& K, double last, LinearSolver& solver,
                                        const Progress& progress) {
  const VectorX diagonal = K.diagonal();
  const double mean = diagonal.size() == 0 ? 0.0 : diagonal.cwiseAbs().mean();
  double tau = 0.0;
  while (tau <= kLastShift && !progress.stop_requested()) {
    const Factorisation outcome = solver.factorise(K, tau * mean);
    if (outcome == Factorisation::kDone) return tau;
    if (outcome != Factorisation::kNotPositiveDefinite) return std::nullopt;
    tau = tau == 0.0 ? std::max(kFirstShift, last / kShiftGrowth) : tau * kShiftGrowth;
  }
  return std::nullopt;
}

/// \param expected_mj  the change of energy to first order, negative for a descent.
bool acceptable(const Iterate& from, const Iterate& to, double expected_mj,
                const NewtonOptions& options) {
  const double change_mj = to.balance.energy_mj - from.balance.energy_mj;
  const double round_off_mj = from.balance.energy_round_off_mj + to.balance.energy_round_off_mj;
  if (-expected_mj > round_off_mj) return change_mj <= options.sufficient_decrease * expected_mj;
  return to.residual_n < from.residual_n;
}

struct Step {
  Iterate to;
  double length;
};

/// Shortens the step `dx` until it is acceptable. The next length is where the slope, interpolated
/// between both ends, vanishes.
std::optional<Step> backtrack(const NonlinearSystem& system, const Iterate& from, const VectorX& dx,
                              const NewtonOptions& options) {
  const double slope_mj = from.balance.residual_n.dot(dx);
  double length = 1.0;
  for (int n = 0; n <= options.max_backtracks; ++n) {
    std::optional<Iterate> to = iterate_at(system, from.x + length * dx);
    if (to && acceptable(from, *to, length * slope_mj, options))
      return Step{*std::move(to), length};
    double factor = kShortenLeast;
    if (to) {
      const double zero_of_slope = slope_mj / (slope_mj - to->balance.residual_n.dot(dx));
      if (zero_of_slope > 0.0) factor = std::clamp(zero_of_slope, kShortenMost, kShortenLeast);
    }
    length *= factor;
  }
  return std::nullopt;
}

/// Counts the steps since something last improved.
class Headway {
 public:
  /// \returns how many steps in a row, this one included, made none.
  int steps_without(const Iterate& from, const Iterate& to) {
    const bool lower_energy =
        from.balance.energy_mj - to.balance.energy_mj > kClearly * to.balance.energy_round_off_mj;
    const bool lower_residual = to.residual_n < kNotably * best_residual_n_;
    best_residual_n_ = std::min(best_residual_n_, to.residual_n);
    return without_ = lower_energy || lower_residual ? 0 : without_ + 1;
  }

  explicit Headway(double residual_n) : best_residual_n_(residual_n) {}

 private:
  static constexpr double kClearly = 10.0;
  static constexpr double kNotably = 0.9;
  double best_residual_n_;
  int without_ = 0;
};

double tolerance_n(const Iterate& at, const NewtonOptions& options) {
  return std::max(options.relative_tolerance * at.balance.force_scale_n,
                  options.absolute_tolerance_n);
}

NewtonIterate history_line(const Iterate& at, double step_length, double shift) {
  return {.residual_n = at.residual_n,
          .force_scale_n = at.balance.force_scale_n,
          .energy_mj = at.balance.energy_mj,
          .step_length = step_length,
          .shift = shift};
}

}  // namespace

Result<void> validate(const NewtonOptions& options) {
  const auto refuse = [](const char* what, auto value, const char* wanted) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("newton: {} is {}, must be {}", what, value, wanted));
  };
  if (!(options.relative_tolerance >= 0.0 && options.relative_tolerance < 1.0))
    return refuse("relative_tolerance", options.relative_tolerance, "in [0, 1)");
  if (!(options.absolute_tolerance_n >= 0.0))
    return refuse("absolute_tolerance_n", options.absolute_tolerance_n, ">= 0 N");
  if (options.max_iterations < 1) return refuse("max_iterations", options.max_iterations, ">= 1");
  if (options.max_backtracks < 0) return refuse("max_backtracks", options.max_backtracks, ">= 0");
  if (!(options.sufficient_decrease > 0.0 && options.sufficient_decrease < 0.5))
    return refuse("sufficient_decrease", options.sufficient_decrease, "in (0, 0.5)");
  if (options.stagnation_iterations < 1)
    return refuse("stagnation_iterations", options.stagnation_iterations, ">= 1");
  return {};
}

NewtonOutcome solve_newton(const NonlinearSystem& system, VectorX start,
                           LinearSolver& linear_solver, const NewtonOptions& options,
                           Progress& progress) {
  LEFORT_CHECK(validate(options).has_value());
  NewtonOutcome outcome;
  std::optional<Iterate> first = iterate_at(system, start);
  if (!first) {
    outcome.x = std::move(start);
    outcome.reason = "the start is inadmissible: an element is inside out or a force not finite";
    return outcome;
  }

  Iterate at = *std::move(first);
  Headway headway(at.residual_n);
  outcome.history.push_back(history_line(at, 0.0, 0.0));
  const auto stop = [&](NewtonStop why, const std::string& what) {
    outcome.stop = why;
    outcome.reason =
        fmt::format("{} after {} iterations: |r| is {:.3e} N, must be <= {:.3e} N", what,
                    outcome.iterations(), at.residual_n, tolerance_n(at, options));
    outcome.x = std::move(at.x);
    return std::move(outcome);
  };

  while (!(at.residual_n <= tolerance_n(at, options))) {  // Written so that NaN is not converged.
    if (outcome.iterations() == options.max_iterations)
      return stop(NewtonStop::kTooManyIterations, "not converged");
    const std::optional<double> shift = factorise_shifted(
        system.tangent(at.x), outcome.history.back().shift, linear_solver, progress);
    if (progress.stop_requested()) return stop(NewtonStop::kCancelled, "cancelled");
    if (!shift) return stop(NewtonStop::kSingularTangent, "tangent not positive definite");

    const VectorX dx = linear_solver.solve(-at.balance.residual_n);
    std::optional<Step> step = backtrack(system, at, dx, options);
    if (!step) return stop(NewtonStop::kStagnated, "no step leads downhill");

    const int idle = headway.steps_without(at, step->to);
    at = std::move(step->to);
    outcome.history.push_back(history_line(at, step->length, *shift));
    if (idle >= options.stagnation_iterations && !(at.residual_n <= tolerance_n(at, options)))
      return stop(NewtonStop::kStagnated, fmt::format("no headway for {} iterations", idle));
  }
  return stop(NewtonStop::kConverged, "converged");
}

}  // namespace lefort::fem
