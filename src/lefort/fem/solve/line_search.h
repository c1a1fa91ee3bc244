/// \file
/// Line search of solve_newton(): steps 5 to 7 of its algorithm.
#pragma once

#include <lefort/fem/solve/newton_state.h>

#include <optional>

namespace lefort::fem::internal {

/// An accepted step.
struct Step {
  NewtonState to;
  double length;  ///< alpha.
};

/// Finds alpha <= 1 with sufficient decrease of the energy (\cite nocedal2006, equation (3.4)):
///
///   W(x + alpha dx) <= W(x) + c alpha r . dx
///
/// or, if the expected change alpha r . dx is within the round-off of W, with a decrease of |r|.
/// The next trial alpha is the zero of the linearly interpolated slope, limited to 0.1 to 0.5 times
/// the last alpha. After an inadmissible state it is 0.5 times the last alpha.
/// \param dx       direction of descent.
/// \param options  c = sufficient_decrease; max_backtracks; max_step_length limits the first alpha.
/// \returns the step, or nothing if no alpha was accepted after max_backtracks reductions.
[[nodiscard]] std::optional<Step> backtrack(const NonlinearSystem& system, const NewtonState& from,
                                            const VectorX& dx, const NewtonOptions& options);

/// Tries alpha = 1, 1/2, 1/4, ... along the solution of (K + A) dx = -r, until the condition of
/// backtrack() holds or
///
///   |r(x + alpha dx)| <= (1 - c alpha) |r(x)|
///
/// \param dx       direction; it need not descend.
/// \param options  c = sufficient_decrease; max_step_length limits the first alpha.
/// \returns the step, or nothing after kNonsymmetricTrials: the direction of K alone may be better.
[[nodiscard]] std::optional<Step> backtrack_nonsymmetric(const NonlinearSystem& system,
                                                         const NewtonState& from, const VectorX& dx,
                                                         const NewtonOptions& options);

/// Expands an accepted step while the energy decreases and the curvature condition fails
/// (\cite nocedal2006, equation (3.5)). A blended or shifted tangent is too stiff along unstable
/// directions, so that its full steps are short.
/// \param dx       direction of `step`.
/// \param step     accepted by backtrack().
/// \param options  sufficient_decrease; max_backtracks is the max number of expansions;
///   max_step_length ends the expansion.
/// \returns the last accepted step.
[[nodiscard]] Step expand_step(const NonlinearSystem& system, const NewtonState& from,
                               const VectorX& dx, Step step, const NewtonOptions& options);

}  // namespace lefort::fem::internal
