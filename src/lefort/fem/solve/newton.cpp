#include <lefort/core/check.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/linear/gmres.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lefort::fem {
namespace {

/// The first shift tried on an indefinite tangent, the factor to the next, and the last, all as a
/// share of its diagonal: beyond the last the matrix is not a stiffness any more.
constexpr double kFirstShift = 1e-3;
constexpr double kShiftGrowth = 4.0;
constexpr double kLastShift = 1e3;

/// Likewise for the part of the convex tangent; the last is 1.
constexpr double kFirstFraction = 0.25;
constexpr double kFractionGrowth = 2.0;

/// How much a step is shortened at least and at most.
constexpr double kMinContraction = 0.5;
constexpr double kMaxContraction = 0.1;

/// A step that was shortened to less reached too far: the next tangent is to be more convex.
constexpr double kTooFar = 0.5;

/// A step is lengthened where the slope at its end is still so much of that at its start; by how
/// much at least and at most.
constexpr double kSufficientSlopeReduction = 0.3;
constexpr double kMinExpansion = 1.5;
constexpr double kMaxExpansion = 4.0;

/// An admissible state and what is known there.
struct NewtonState {
  VectorX x;
  ResidualState residual_state;
  double residual_n = 0.0;
  double energy_mj = 0.0;  ///< W, and minus the work of followers since the start.
};

/// \param from  the state the step to x begins at; null at the start.
std::optional<NewtonState> iterate_at(const NonlinearSystem& system, VectorX x,
                                      const NewtonState* from = nullptr) {
  if (!x.allFinite()) return std::nullopt;
  std::optional<ResidualState> residual_state = system.residual_state(x);
  if (!residual_state) return std::nullopt;
  const double residual_n = residual_state->residual_n.norm();
  double energy_mj = residual_state->energy_mj;
  if (from != nullptr && residual_state->follower_n.size() > 0)
    energy_mj +=
        from->energy_mj - from->residual_state.energy_mj +
        0.5 * (from->residual_state.follower_n + residual_state->follower_n).dot(x - from->x);
  if (!std::isfinite(residual_n) || !std::isfinite(energy_mj)) return std::nullopt;
  return NewtonState{std::move(x), *std::move(residual_state), residual_n, energy_mj};
}

/// What a step was taken by.
struct TangentModel {
  double tangent_blend = 0.0;  ///< Of the convex tangent; the rest is the exact one.
  double diagonal_shift = 0.0;
  bool reached_too_far = false;  ///< Its step had to be shortened.
};

/// (1 - share) A + share B, both of one pattern.
linear::SparseMatrix blend(const linear::SparseMatrix& A, const linear::SparseMatrix& B,
                           double fraction) {
  linear::SparseMatrix sum = A;
  sum.coeffs() += fraction * (B.coeffs() - A.coeffs());
  return sum;
}

/// K + tau D, D the magnitudes of the diagonal of K, none nearly zero beside the others.
linear::SparseMatrix shifted(const linear::SparseMatrix& K, double tau) {
  constexpr double kMinimum = 1e-3;
  const VectorX diagonal = K.diagonal().cwiseAbs();
  const VectorX D = diagonal.cwiseMax(kMinimum * diagonal.mean());
  linear::SparseMatrix sum = K;
  sum.diagonal() += tau * D;
  return sum;
}

/// A step and what it was found by.
struct SearchDirection {
  VectorX dx;
  TangentModel model;
  std::optional<VectorX> unsymmetric_dx = {};  ///< By K + A, where there is an A and it was found.
};

/// Whether there is more in A than the rounding of parts that cancel, as on a rim that slides in a
/// plane.
bool is_unsymmetric(const linear::SparseMatrix& K, const linear::SparseMatrix& A) {
  constexpr double kRoundOff = 1e-10;  // Of the stiffness.
  return A.nonZeros() > 0 && A.coeffs().abs().maxCoeff() > kRoundOff * K.coeffs().abs().maxCoeff();
}

/// Solves (K + A) dx = b, K given by its lower triangle and A by the one below its diagonal; with
/// what `solver` has prepared as preconditioner.
std::optional<VectorX> solve_unsymmetric(const linear::SparseMatrix& K,
                                         const linear::SparseMatrix& A, const VectorX& b,
                                         double tolerance, linear::LinearSolver& solver) {
  constexpr int kMaxIterations = 200;
  constexpr double kUseful = 0.1;  // A step that leaves less is better than one by K alone.
  constexpr double kCloser =
      1e-2;                        // An iteration is cheap beside the factor that is there already.
  constexpr double kRough = 1e-2;  // Of a preconditioner by iterations.
  const auto multiply = [&](const VectorX& x) {
    VectorX y = K.selfadjointView<Eigen::Lower>() * x;
    y += A * x;
    y -= A.transpose() * x;
    return y;
  };
  const auto precondition = [&](const VectorX& r) -> std::optional<VectorX> {
    auto z = solver.solve(r, kRough);
    if (!z) return std::nullopt;
    return *std::move(z);
  };
  auto found =
      linear::solve_by_gmres(multiply, precondition, b, kCloser * tolerance, kMaxIterations);
  if (!found || found->left > kUseful) return std::nullopt;
  return std::move(found->x);
}

/// Solves for the step by the exact tangent; if that is not positive definite, by one with as
/// little of the convex one as helps; if even the convex one is not, by that with as little shift
/// as helps.
///
/// \param last       of the step before.
/// \param tolerance  of an iterative solver.
/// \returns the step, or why there is none.
tl::expected<SearchDirection, NewtonStop> find_direction(const NonlinearSystem& system,
                                                         const NewtonState& at,
                                                         const TangentModel& last, double tolerance,
                                                         linear::LinearSolver& solver,
                                                         const NewtonOptions& options,
                                                         const Progress& progress) {
  const VectorX right_side = -at.residual_state.residual_n;
  const auto solve = [&](const linear::SparseMatrix& A) {
    enter(SolvePhase::kFactorization, options);
    auto dx = solver.solve(A, right_side, tolerance, [&] { enter(SolvePhase::kSolve, options); });
    enter(SolvePhase::kAssembly, options);
    return dx;
  };
  const linear::SparseMatrix exact = system.tangent(at.x, Tangent::kExact);
  const linear::SparseMatrix A = system.antisymmetric_tangent(at.x);
  const auto direction = [&](VectorX dx, const TangentModel& model) {
    SearchDirection found{std::move(dx), model};
    if (is_unsymmetric(exact, A)) {
      enter(SolvePhase::kSolve, options);
      found.unsymmetric_dx = solve_unsymmetric(exact, A, right_side, tolerance, solver);
      enter(SolvePhase::kAssembly, options);
    }
    return found;
  };
  auto dx = solve(exact);
  if (dx) return direction(*std::move(dx), {});

  linear::SparseMatrix convex;
  TangentModel model;
  while (!dx && dx.error() == linear::LinearSolveStatus::kNotPositiveDefinite &&
         model.diagonal_shift <= kLastShift) {
    if (progress.stop_requested()) return tl::unexpected(NewtonStop::kCancelled);
    if (model.tangent_blend == 0.0) {
      convex = system.tangent(at.x, Tangent::kPsdProjected);
      const double fraction = last.reached_too_far ? last.tangent_blend * kFractionGrowth
                                                   : last.tangent_blend / kFractionGrowth;
      model.tangent_blend = std::clamp(fraction, kFirstFraction, 1.0);
    } else if (model.tangent_blend < 1.0) {
      model.tangent_blend = std::min(model.tangent_blend * kFractionGrowth, 1.0);
    } else {
      model.diagonal_shift = model.diagonal_shift > 0.0
                                 ? model.diagonal_shift * kShiftGrowth
                                 : std::max(kFirstShift, last.diagonal_shift / kShiftGrowth);
      if (model.diagonal_shift > kLastShift) break;
    }
    dx = solve(model.diagonal_shift > 0.0 ? shifted(convex, model.diagonal_shift)
                                          : blend(exact, convex, model.tangent_blend));
  }
  if (dx) return direction(*std::move(dx), model);
  switch (dx.error()) {
    case linear::LinearSolveStatus::kOutOfMemory:
      return tl::unexpected(NewtonStop::kOutOfMemory);
    case linear::LinearSolveStatus::kNotConverged:
      return tl::unexpected(NewtonStop::kLinearNotConverged);
    default:
      return tl::unexpected(NewtonStop::kSingularTangent);
  }
}

/// \param expected_mj  the change of energy to first order, negative for a descent.
bool acceptable(const NewtonState& from, const NewtonState& to, double expected_mj,
                const NewtonOptions& options) {
  const double change_mj = to.energy_mj - from.energy_mj;
  const double round_off_mj =
      from.residual_state.energy_round_off_mj + to.residual_state.energy_round_off_mj;
  if (-expected_mj > round_off_mj) return change_mj <= options.sufficient_decrease * expected_mj;
  return to.residual_n < from.residual_n;
}

struct Step {
  NewtonState to;
  double length;
};

/// Shortens the step `dx` until it is acceptable. The next length is where the slope, interpolated
/// between both ends, vanishes.
std::optional<Step> backtrack(const NonlinearSystem& system, const NewtonState& from,
                              const VectorX& dx, const NewtonOptions& options) {
  const double slope_mj = from.residual_state.residual_n.dot(dx);
  double length = 1.0;
  for (int n = 0; n <= options.max_backtracks; ++n) {
    std::optional<NewtonState> to = iterate_at(system, from.x + length * dx, &from);
    if (to && acceptable(from, *to, length * slope_mj, options))
      return Step{*std::move(to), length};
    double factor = kMinContraction;
    if (to) {
      const double zero_of_slope = slope_mj / (slope_mj - to->residual_state.residual_n.dot(dx));
      if (zero_of_slope > 0.0) factor = std::clamp(zero_of_slope, kMaxContraction, kMinContraction);
    }
    length *= factor;
  }
  return std::nullopt;
}

/// Shortens a step by K + A until it lowers the energy or |r|; not by much, since where it does not
/// work the other one may.
std::optional<Step> backtrack_nonsymmetric(const NonlinearSystem& system, const NewtonState& from,
                                           const VectorX& dx, const NewtonOptions& options) {
  constexpr int kTrials = 4;
  const double slope_mj = from.residual_state.residual_n.dot(dx);
  double length = 1.0;
  for (int n = 0; n < kTrials; ++n, length *= kMinContraction) {
    std::optional<NewtonState> to = iterate_at(system, from.x + length * dx, &from);
    if (!to) continue;
    const double enough_n = (1.0 - options.sufficient_decrease * length) * from.residual_n;
    if (to->residual_n <= enough_n || acceptable(from, *to, length * slope_mj, options))
      return Step{*std::move(to), length};
  }
  return std::nullopt;
}

/// Goes on along `dx` while that pays: a tangent made convex knows nothing of how far down an
/// unstable direction leads, so that steps along it are short.
Step expand_step(const NonlinearSystem& system, const NewtonState& from, const VectorX& dx,
                 Step step, const NewtonOptions& options) {
  const double slope_mj = from.residual_state.residual_n.dot(dx);
  for (int n = 0; n < options.max_backtracks; ++n) {
    const double slope_here_mj = step.to.residual_state.residual_n.dot(dx);
    if (!(slope_here_mj < kSufficientSlopeReduction * slope_mj)) break;
    const double factor =
        slope_here_mj <= slope_mj
            ? kMaxExpansion
            : std::clamp(slope_mj / (slope_mj - slope_here_mj), kMinExpansion, kMaxExpansion);
    const double length = factor * step.length;
    std::optional<NewtonState> to = iterate_at(system, from.x + length * dx, &from);
    if (!to || to->energy_mj >= step.to.energy_mj ||
        !acceptable(from, *to, length * slope_mj, options))
      break;
    step = {*std::move(to), length};
  }
  return step;
}

/// Counts the steps since something last improved.
class StagnationMonitor {
 public:
  explicit StagnationMonitor(const NewtonState& start)
      : first_energy_mj_(start.energy_mj), best_residual_n_(start.residual_n) {}

  /// \returns how many steps in a row, this one included, made none.
  int stalled_steps(const NewtonState& from, const NewtonState& to, bool is_shifted) {
    const double gain_mj = from.energy_mj - to.energy_mj;
    const double gained_mj = first_energy_mj_ - from.energy_mj;
    const double wanted_mj = std::max(kClearly * to.residual_state.energy_round_off_mj,
                                      is_shifted ? kPart * gained_mj : 0.0);
    const bool lower_residual = to.residual_n < kNotably * best_residual_n_;
    best_residual_n_ = std::min(best_residual_n_, to.residual_n);
    return without_ = gain_mj > wanted_mj || lower_residual ? 0 : without_ + 1;
  }

 private:
  static constexpr double kClearly = 10.0;
  static constexpr double kNotably = 0.9;
  static constexpr double kPart = 1e-3;
  double first_energy_mj_;
  double best_residual_n_;
  int without_ = 0;
};

double tolerance_n(const NewtonState& at, const NewtonOptions& options) {
  return std::max(options.relative_tolerance * at.residual_state.residual_reference_n,
                  options.absolute_tolerance_n);
}

/// Whether what is left of r beside its round-off is small.
bool is_round_off(const NewtonState& at, const NewtonOptions& options) {
  if (options.round_off_n.size() == 0) return false;
  const VectorX left =
      (at.residual_state.residual_n.cwiseAbs() - options.round_off_n).cwiseMax(0.0);
  return left.norm() <= options.relative_tolerance * at.residual_state.residual_reference_n;
}

/// \param iterations  done so far.
bool is_converged(const NewtonState& at, int iterations, const NewtonOptions& options) {
  constexpr double kNearlyAll = 1e-3;  // Of the forces that cancel: they may well be no round-off.
  if (at.residual_n <= tolerance_n(at, options)) return true;
  const bool tried = options.may_start_at_rest || iterations > 0 ||
                     at.residual_n <= kNearlyAll * at.residual_state.residual_reference_n;
  return tried && is_round_off(at, options);
}

const char* why_no_direction(NewtonStop why) {
  switch (why) {
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

/// To which part of the residual a step is solved for by iterations: while far from the solution
/// not more exactly than the step itself is right, and so exactly towards the end that convergence
/// stays quadratic (\cite eisenstat1996, choice 2).
class ForcingTerm {
 public:
  /// \param wanted_n  the residual at which Newton stops.
  double next(double residual_n, double wanted_n) {
    const double ratio = last_residual_n_ > 0.0 ? residual_n / last_residual_n_ : 1.0;
    last_residual_n_ = residual_n;
    const double enough = residual_n > 0.0 ? kBeyond * wanted_n / residual_n : kLoosest;
    return std::clamp(ratio * ratio, std::clamp(enough, kTightest, kLoosest), kLoosest);
  }

 private:
  static constexpr double kLoosest = 1e-2, kTightest = 1e-10, kBeyond = 0.1;
  double last_residual_n_ = 0.0;
};

NewtonIterate history_line(const NewtonState& at, double step_length, const TangentModel& model) {
  return {.residual_n = at.residual_n,
          .residual_reference_n = at.residual_state.residual_reference_n,
          .energy_mj = at.energy_mj,
          .step_length = step_length,
          .tangent_blend = model.tangent_blend,
          .diagonal_shift = model.diagonal_shift,
          .contacts = at.residual_state.contacts};
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
                           linear::LinearSolver& linear_solver, const NewtonOptions& options,
                           Progress& progress) {
  LEFORT_CHECK(validate(options).has_value());
  LEFORT_CHECK(options.round_off_n.size() == 0 || options.round_off_n.size() == start.size());
  NewtonOutcome outcome;
  enter(SolvePhase::kAssembly, options);
  std::optional<NewtonState> first = iterate_at(system, start);
  if (!first) {
    outcome.x = std::move(start);
    enter(SolvePhase::kNone, options);
    outcome.reason = "the start is inadmissible: an element is inside out or a force not finite";
    return outcome;
  }

  NewtonState at = *std::move(first);
  StagnationMonitor stagnation(at);
  ForcingTerm forcing;
  TangentModel model;
  const auto note = [&](double step_length) {
    outcome.history.push_back(history_line(at, step_length, model));
    if (options.on_iterate) options.on_iterate(outcome.history.back(), at.residual_state);
  };
  note(0.0);
  const auto stop = [&](NewtonStop why, const std::string& what) {
    outcome.stop = why;
    outcome.reason =
        fmt::format("{} after {} iterations: |r| is {:.3e} N, must be <= {:.3e} N", what,
                    outcome.iterations(), at.residual_n, tolerance_n(at, options));
    outcome.x = std::move(at.x);
    enter(SolvePhase::kNone, options);
    return std::move(outcome);
  };

  while (!is_converged(at, outcome.iterations(), options)) {
    if (outcome.iterations() == options.max_iterations)
      return stop(NewtonStop::kTooManyIterations, "not converged");
    const double tolerance = forcing.next(at.residual_n, tolerance_n(at, options));
    auto direction = find_direction(system, at, model, tolerance, linear_solver, options, progress);
    if (progress.stop_requested()) return stop(NewtonStop::kCancelled, "cancelled");
    if (!direction) return stop(direction.error(), why_no_direction(direction.error()));
    model = direction->model;

    const VectorX& dx = direction->dx;
    std::optional<Step> step;
    if (direction->unsymmetric_dx)
      step = backtrack_nonsymmetric(system, at, *direction->unsymmetric_dx, options);
    const bool is_unsymmetric = step.has_value();
    if (!step) step = backtrack(system, at, dx, options);
    if (!step && is_round_off(at, options)) break;
    if (!step) return stop(NewtonStop::kStagnated, "no step leads downhill");

    model.reached_too_far = step->length < kTooFar;
    if (model.tangent_blend > 0.0 && step->length == 1.0 && !is_unsymmetric)
      step = expand_step(system, at, dx, *std::move(step), options);

    const int idle = stagnation.stalled_steps(at, step->to, model.diagonal_shift > 0.0);
    at = std::move(step->to);
    note(step->length);
    if (idle >= options.stagnation_iterations && !is_converged(at, outcome.iterations(), options))
      return stop(NewtonStop::kStagnated, fmt::format("no headway for {} iterations", idle));
  }
  return stop(NewtonStop::kConverged, "converged");
}

}  // namespace lefort::fem
