/// \file
/// Settings of Newton's method and of the load increments of a prediction.
#pragma once

#include <lefort/fem/solve/load_steps.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/predict/prediction_options.h>

namespace lefort::predict {

/// \param solver  tolerance and number of iterations.
/// \param tissue  Young's modulus and element size, for the residual of a body without loads.
[[nodiscard]] fem::NewtonOptions newton_options(const SolverOptions& solver,
                                                const TissueOptions& tissue);

/// \param solver     its min_increment_ratio is used.
/// \param increment  first and max increment of the path fraction.
[[nodiscard]] fem::LoadStepOptions load_step_options(const SolverOptions& solver, double increment);

}  // namespace lefort::predict
