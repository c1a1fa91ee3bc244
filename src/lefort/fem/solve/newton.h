/// \file
/// Newton's method with line search for equations that are, but for follower loads, the gradient of
/// an energy.
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

/// The forces at one state.
struct ResidualState {
  double energy_mj = 0.0;             ///< W(x) [mJ].
  VectorX residual_n;                 ///< r(x) = dW/dx + follower_n [N], zero in equilibrium.
  VectorX follower_n = {};            ///< What is no energy's gradient [N]; empty if there is none.
  double residual_reference_n = 0.0;  ///< Size of the forces that cancel in r [N]; see Assembler.
  double energy_round_off_mj = 0.0;   ///< Differences of W below this say nothing [mJ].
  Index contacts = 0;                 ///< Points in contact, for the history.
  double deepest_mm = 0.0;            ///< How deep one of them lies, for who watches [mm].
};

/// r(x) = 0. x holds the free displacements [mm].
class NonlinearSystem {
 public:
  virtual ~NonlinearSystem() = default;

  /// \returns the balance at x, or nothing if x is inadmissible: an element turned inside out, NaN.
  [[nodiscard]] virtual std::optional<ResidualState> residual_state(const VectorX& x) const = 0;

  /// \returns the symmetric part of dr/dx [N/mm] or its convex stand-in, lower triangle with the
  ///   whole diagonal, always with the same pattern.
  /// \pre x is admissible.
  [[nodiscard]] virtual linear::SparseMatrix tangent(const VectorX& x, Tangent kind) const = 0;

  /// \returns the strictly lower triangle L of the antisymmetric part L - L^T of dr/dx; 0 by 0 if
  ///   r is the gradient of an energy. \pre x is admissible.
  [[nodiscard]] virtual linear::SparseMatrix antisymmetric_tangent(const VectorX& /*x*/) const {
    return {};
  }
};

/// One line of the history.
struct NewtonIterate {
  double residual_n = 0.0;  ///< |r| [N].
  double residual_reference_n =
      0.0;                     ///< [N]; residual_n / residual_reference_n is the relative residual.
  double energy_mj = 0.0;      ///< Of followers: minus their work on the way from the start.
  double step_length = 0.0;    ///< Taken to come here, in Newton steps; 0 at the start.
  double tangent_blend = 0.0;  ///< Of the convex tangent in the one the step was taken by.
  double diagonal_shift = 0.0;  ///< tau: tau times its diagonal was added to it.
  Index contacts = 0;           ///< Points in contact here.
};

/// What a solve spends its time on.
enum class SolvePhase { kAssembly, kFactorization, kSolve, kNone };

struct NewtonOptions {
  double relative_tolerance = 1e-8;   ///< Converged when |r| <= this * force scale, >= 0 ...
  double absolute_tolerance_n = 0.0;  ///< ... or when |r| <= this [N], >= 0: a body at rest, whose
                                      ///< forces are all round-off.
  /// How much of each component of r may be round-off [N]: converged, too, when what is left of r
  /// satisfies the relative tolerance. Empty: none; find_equilibrium() wants all 3 per node.
  VectorX round_off_n = {};
  /// Whether a start may be accepted because its r is nearly all round-off. False where something
  /// pushes: a step is then tried first.
  bool may_start_at_rest = true;
  int max_iterations = 30;            ///< Newton steps, at most; >= 1.
  int max_backtracks = 20;            ///< How often one step may be shortened; >= 0.
  double sufficient_decrease = 1e-4;  ///< Armijo's constant, in (0, 0.5).
  int stagnation_iterations = 8;      ///< Stop when so many steps in a row make no headway; >= 1.
  /// Told what comes next, from the calling thread: for who looks at the clock. May be empty.
  std::function<void(SolvePhase)> on_phase{};
  /// Told each line of the history as it is found, likewise: for who watches. May be empty.
  std::function<void(const NewtonIterate&, const ResidualState&)> on_iterate{};
};

/// \returns kInvalidArgument, naming the option that lies outside its range.
[[nodiscard]] Result<void> validate(const NewtonOptions& options);

/// Tells options.on_phase.
inline void enter(SolvePhase phase, const NewtonOptions& options) {
  if (options.on_phase) options.on_phase(phase);
}

enum class NewtonStop {
  kConverged,
  kTooManyIterations,
  kStagnated,           ///< No step, or many steps in a row, brought no headway.
  kSingularTangent,     ///< No shift made the tangent positive definite: nothing holds the body.
  kLinearNotConverged,  ///< An iterative linear solver gave up.
  kOutOfMemory,  ///< The factor does not fit into memory; the problem may well have a solution.
  kInadmissibleStart,  ///< The start itself turns an element inside out, or is not finite.
  kRejected,           ///< Converged to a state that the caller does not accept.
  kCancelled           ///< Progress asked to stop.
};

/// What came out, whether or not it converged.
struct NewtonOutcome {
  NewtonStop stop = NewtonStop::kInadmissibleStart;
  std::string reason;                  ///< Why it stopped: a sentence with the figures.
  VectorX x;                           ///< The last admissible state; the start if there is none.
  std::vector<NewtonIterate> history;  ///< The start, then one line per iteration.

  [[nodiscard]] bool converged() const { return stop == NewtonStop::kConverged; }
  [[nodiscard]] int iterations() const {
    return history.empty() ? 0 : static_cast<int>(history.size()) - 1;
  }
};

/// Solves r(x) = 0 from `start`.
///
/// Each step goes along -(K + tau D)^-1 r and is shortened until the energy falls sufficiently
/// (Armijo; \cite nocedal2006, algorithm 3.1). K is the exact tangent; where that is not positive
/// definite, a mean of it and the convex one, with as little of that as helps. D is the diagonal of
/// K, and tau = 0 unless even the convex one is not (ibid., algorithm 3.3). Where the expected
/// change of energy drowns in its round-off, |r| has to fall instead. A trial that is inadmissible
/// is shortened like one that is too high. A step by another than the exact tangent, being too
/// short along unstable directions, is lengthened while that pays.
///
/// Where a part of r is no energy's gradient, minus its work along the straight step, by the
/// trapezoidal rule, takes its place in W; and dr/dx is K + A with an antisymmetric A. The step is
/// then solved for by GMRES, preconditioned by what was factorized, and taken if it lowers that W
/// or |r|. If it does neither, a step by K alone is tried: it goes down that W, since along a
/// straight line only the symmetric part of dr/dx does work (dx . A dx = 0).
///
/// A step makes headway if |r| falls notably or the energy clearly; a shifted step, which may creep
/// downhill without end, only if it gains a notable part of what was gained so far.
///
/// \param options        \pre valid.
/// An iterative linear solver is asked for as much accuracy as each step deserves.
///
/// \param linear_solver  keeps its symbolic analysis from one call to the next.
/// \param progress       asked before every iteration and factorization whether to stop.
[[nodiscard]] NewtonOutcome solve_newton(const NonlinearSystem& system, VectorX start,
                                         linear::LinearSolver& linear_solver,
                                         const NewtonOptions& options = {},
                                         Progress& progress = Progress::none());

}  // namespace lefort::fem
