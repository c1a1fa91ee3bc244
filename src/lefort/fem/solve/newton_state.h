/// \file
/// State and tangent that the parts of solve_newton() exchange.
#pragma once

#include <lefort/fem/solve/newton.h>

#include <optional>

namespace lefort::fem::internal {

/// An admissible state.
struct NewtonState {
  VectorX x;
  ResidualState residual_state;
  double residual_n = 0.0;  ///< |r|.
  /// W plus the integral of f . dx along the steps since the start, f being the part of r without a
  /// potential.
  double energy_mj = 0.0;
};

/// \param x     free displacements [mm].
/// \param from  state at which the step to x begins; null at the start. The integral of f . dx is
///   (f_from + f_x) / 2 . (x - x_from).
/// \returns the state at x, or nothing if x is inadmissible or not finite.
[[nodiscard]] std::optional<NewtonState> evaluate_state(const NonlinearSystem& system, VectorX x,
                                                        const NewtonState* from = nullptr);

/// The symmetric tangent of a step: (1 - beta) K + beta K+ + tau D.
struct TangentModel {
  double tangent_blend = 0.0;   ///< beta.
  double diagonal_shift = 0.0;  ///< tau.
  bool is_step_short = false;   ///< The step by this tangent had to be shortened (kShortStep).
};

}  // namespace lefort::fem::internal
