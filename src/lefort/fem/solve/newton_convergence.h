/// \file
/// Convergence, stagnation and linear tolerance of solve_newton(): steps 1, 2 and 8 of its
/// algorithm.
#pragma once

#include <lefort/fem/solve/newton_state.h>

namespace lefort::fem::internal {

/// \returns |r| at or below which a state has converged [N].
[[nodiscard]] double tolerance_n(const NewtonState& at, const NewtonOptions& options);

/// \returns whether the part of r beyond NewtonOptions::round_off_n satisfies the relative
///   tolerance; false if round_off_n is empty.
[[nodiscard]] bool is_round_off(const NewtonState& at, const NewtonOptions& options);

/// \param iterations  number of steps so far.
[[nodiscard]] bool is_converged(const NewtonState& at, int iterations,
                                const NewtonOptions& options);

/// Counts the steps in a row that reduce neither energy nor |r| enough (newton_constants.h).
class StagnationMonitor {
 public:
  explicit StagnationMonitor(const NewtonState& start)
      : first_energy_mj_(start.energy_mj), min_residual_n_(start.residual_n) {}

  /// \param is_shifted  whether the step was taken by a tangent with a diagonal shift.
  /// \returns the number of steps in a row, this one included, without progress.
  int stalled_steps(const NewtonState& from, const NewtonState& to, bool is_shifted);

 private:
  double first_energy_mj_;
  double min_residual_n_;
  int stalled_ = 0;
};

/// Tolerance of the linear solve of each step (\cite eisenstat1996, choice 2, with gamma = 1 and
/// alpha = 2).
class EisenstatWalkerTolerance {
 public:
  /// \param options  max_linear_tolerance and min_linear_tolerance are used.
  explicit EisenstatWalkerTolerance(const NewtonOptions& options)
      : max_(options.max_linear_tolerance), min_(options.min_linear_tolerance) {}

  /// \param residual_n   |r| at the start of the step.
  /// \param converged_n  |r| at which Newton's method converges. The tolerance is not less than
  ///   kOversolvingFraction times converged_n / residual_n, within the limits of the options.
  /// \returns the relative tolerance.
  double next(double residual_n, double converged_n);

 private:
  double max_;
  double min_;
  double last_residual_n_ = 0.0;
};

}  // namespace lefort::fem::internal
