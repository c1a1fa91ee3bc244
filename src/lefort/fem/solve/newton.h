/// \file
/// Newton's method with line search for equations r(x) = 0, where r is the gradient of an energy
/// plus forces without a potential (follower loads).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/tangent.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/linear/sparse_matrix.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lefort::fem {

/// Residual and energy at one state.
struct ResidualState {
  double energy_mj = 0.0;             ///< W(x) [mJ].
  VectorX residual_n;                 ///< r(x) = dW/dx + follower_n [N], zero in equilibrium.
  VectorX follower_n = {};            ///< Part of r without a potential [N]; empty if none.
  double residual_reference_n = 0.0;  ///< Size of the forces that cancel in r [N]; see Assembler.
  double energy_round_off_mj = 0.0;   ///< Differences of W below this are round-off [mJ].
  Index contacts = 0;                 ///< Points in contact; for the history.
  double deepest_mm = 0.0;            ///< Max penetration increase of these points [mm].
};

/// The equations r(x) = 0; x holds the free displacements [mm].
class NonlinearSystem {
 public:
  virtual ~NonlinearSystem() = default;

  /// \returns the residual at x, or nothing if x is inadmissible: an element is inverted, or NaN.
  [[nodiscard]] virtual std::optional<ResidualState> residual_state(const VectorX& x) const = 0;

  /// \returns why x is inadmissible, for messages; empty if it is admissible or unknown.
  [[nodiscard]] virtual std::string inadmissible_cause(const VectorX& /*x*/) const { return {}; }

  /// \returns the symmetric part of dr/dx, or the stabilized tangent (tangent.h) [N/mm]: the
  ///   lower triangle with the whole diagonal, always with the same pattern.
  /// \pre x is admissible.
  [[nodiscard]] virtual linear::SparseMatrix tangent(const VectorX& x, Tangent kind) const = 0;

  /// \returns the strictly lower triangle L of the antisymmetric part L - L^T of dr/dx; 0 by 0 if
  ///   r is the gradient of an energy. \pre x is admissible.
  [[nodiscard]] virtual linear::SparseMatrix antisymmetric_tangent(const VectorX& /*x*/) const {
    return {};
  }
};

/// One line of the history: a state and the step that led to it.
struct NewtonIterate {
  double residual_n = 0.0;            ///< |r| [N].
  double residual_reference_n = 0.0;  ///< [N]; the relative residual is |r| divided by this.
  double energy_mj = 0.0;             ///< W minus the work of follower loads from the start [mJ].
  double step_length = 0.0;           ///< alpha; 0 at the start.
  double tangent_blend = 0.0;         ///< beta of the tangent of the step.
  double diagonal_shift = 0.0;        ///< tau of the tangent of the step.
  Index contacts = 0;                 ///< Points in contact.
};

/// Phases of a solve; for timing.
enum class SolvePhase { kAssembly, kFactorization, kSolve, kNone };

struct NewtonOptions {
  /// Converged if |r| <= this times the residual reference; in [0, 1).
  double relative_tolerance = 1e-8;
  /// Converged if |r| <= this [N], >= 0: for a body at rest, whose forces are all round-off.
  double absolute_tolerance_n = 0.0;
  /// Bound of the round-off of each component of r [N]: also converged if the part of r beyond this
  /// bound satisfies the relative tolerance. Empty: none. For find_equilibrium(): 3 per node.
  VectorX round_off_n = {};
  /// Whether round_off_n may accept a start with any |r|. Set to false if a load acts: round_off_n
  /// then accepts only a start with a small |r| (kMaxRoundOffFraction), or a start from which no
  /// step is acceptable.
  bool may_accept_start_by_round_off = true;
  int max_iterations = 30;  ///< Max number of steps; >= 1.
  int max_backtracks = 20;  ///< Max number of contractions, or expansions, of one step; >= 0.
  /// c of the Armijo condition, in (0, 0.5); the value is that of \cite nocedal2006, section 3.1.
  double sufficient_decrease = 1e-4;
  int stagnation_iterations = 8;  ///< Stop after this many steps without progress; >= 1.
  /// Bounds of the relative tolerance of iterative linear solvers: 0 < min <= max < 1.
  double max_linear_tolerance = 1e-2;
  double min_linear_tolerance = 1e-10;
  /// Largest tau that is tried, >= 0. A larger one would in effect replace K+ by its diagonal.
  double max_diagonal_shift = 1e3;
  /// Returns the largest allowed fraction, in (0, 1], of a step dx from x: a step ends before it
  /// crosses a surface (\cite li2020, section 4.4). Empty: 1. For find_equilibrium() x and dx have
  /// all components.
  std::function<double(const VectorX& x, const VectorX& dx)> max_step_length{};
  /// Called at the start of each phase, on the calling thread; may be empty.
  std::function<void(SolvePhase)> on_phase{};
  /// Called with each line of the history, on the calling thread; may be empty.
  std::function<void(const NewtonIterate&, const ResidualState&)> on_iterate{};
};

/// \returns kInvalidArgument, naming the option that lies outside its range.
[[nodiscard]] Result<void> validate(const NewtonOptions& options);

/// Calls options.on_phase.
inline void enter(SolvePhase phase, const NewtonOptions& options) {
  if (options.on_phase) options.on_phase(phase);
}

/// Why a solve ended.
enum class NewtonStop {
  kConverged,
  kTooManyIterations,
  kStagnated,           ///< No acceptable step, or many steps without progress.
  kSingularTangent,     ///< No tangent was positive definite: the body may lack support.
  kLinearNotConverged,  ///< An iterative linear solver did not converge.
  kOutOfMemory,         ///< The factor does not fit into memory; a solution may exist.
  kInadmissibleStart,   ///< An element is inverted at the start, or the start is not finite.
  kRejected,            ///< Converged to a state that the caller rejects.
  kCancelled            ///< `progress` requested a stop.
};

/// Result of a solve, converged or not.
struct NewtonOutcome {
  NewtonStop stop = NewtonStop::kInadmissibleStart;
  std::string reason;                  ///< Why the solve ended, with residual and tolerance.
  VectorX x;                           ///< Last admissible state; the start if there is none.
  std::vector<NewtonIterate> history;  ///< The start, if admissible, then one line per step.

  [[nodiscard]] bool converged() const { return stop == NewtonStop::kConverged; }
  [[nodiscard]] int iterations() const {
    return history.empty() ? 0 : static_cast<int>(history.size()) - 1;
  }
};

/// Solves r(x) = 0 from `start`, where r = dW/dx + f, and f is a part without a potential (often
/// none). K is the symmetric part of dr/dx, and A its antisymmetric part, which is that of df/dx.
///
/// In each step:
///
/// 1. **Convergence.** End if |r| <= max(relative_tolerance R, absolute_tolerance_n), where R is
///    the residual reference, or if the norm of the part of r beyond round_off_n is at most
///    relative_tolerance R.
/// 2. **Linear tolerance** of iterative solvers: eta_k = (|r_k| / |r_k-1|)^2 within bounds
///    (\cite eisenstat1996, choice 2).
/// 3. **Direction**: K dx = -r. If K is not positive definite, it is replaced by the first positive
///    definite one of
///      - (1 - beta) K + beta K+, where K+ is the stabilized tangent (tangent.h), for growing
///        beta <= 1;
///      - K+ + tau D for growing tau (\cite nocedal2006, algorithm 3.3), where D holds the absolute
///        values of the diagonal of K+, small ones raised (kMinDiagonal).
/// 4. **Forces without a potential**: if A != 0, also (K + A) dx' = -r by GMRES; the factor of step
///    3 is the preconditioner.
/// 5. **Line search along dx'**, if there is one: alpha = 1, 1/2, ... until the condition of step 6
///    holds or |r(x + alpha dx')| <= (1 - c alpha) |r|.
/// 6. **Line search along dx**, if there is no step yet (\cite nocedal2006, algorithm 3.1): Armijo
///    condition W(x + alpha dx) <= W(x) + c alpha r . dx (equation (3.4)). Inadmissible states do
///    not satisfy it. If the expected change of W is within its round-off, |r| must decrease
///    instead. The tangent of step 3 is positive definite, so that dx is a descent direction.
/// 7. **Expansion**: a full step along dx with beta > 0 is expanded while the curvature condition
///    (equation (3.5)) fails and W decreases.
/// 8. **Stagnation**: end if no step was accepted (converged if round_off_n accepts x), or after
///    `stagnation_iterations` steps without progress. Progress is a decrease of W by more than a
///    multiple of its round-off (after a step with tau > 0: also by more than a fraction of the
///    decrease so far), or of the minimum of |r| by 10 %.
///
/// In steps 5 to 7, alpha is at most NewtonOptions::max_step_length.
/// In steps 5 to 8, W contains the integral of f . dx along the steps (minus the work of the
/// loads), by the trapezoidal rule: (f(x) + f(x + alpha dx)) / 2 . alpha dx for each step.
/// Constants are in newton_constants.h.
///
/// \param system         the equations.
/// \param start          free displacements [mm].
/// \param linear_solver  its symbolic analysis is reused from one call to the next.
/// \param options        \pre valid.
/// \param progress       checked in every step, and before every further factorization, for a
///   request to stop.
/// \returns the outcome with the full history; `reason` is set whether or not it converged.
[[nodiscard]] NewtonOutcome solve_newton(const NonlinearSystem& system, VectorX start,
                                         linear::LinearSolver& linear_solver,
                                         const NewtonOptions& options = {},
                                         Progress& progress = Progress::none());

}  // namespace lefort::fem
