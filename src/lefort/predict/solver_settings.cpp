#include <lefort/predict/solver_settings.h>

namespace lefort::predict {
namespace {

/// Residual of a body without loads: round-off. It is proportional to Young's modulus times the
/// area of an element face. The factor lies far above the rounding of double precision, 1e-16, and
/// far below the relative tolerance of a loaded body, 1e-6.
double rest_tolerance_n(const TissueOptions& tissue) {
  constexpr double kFactor = 1e-10;
  return kFactor * tissue.young_mpa * tissue.element_size_mm * tissue.element_size_mm;
}

}  // namespace

fem::NewtonOptions newton_options(const SolverOptions& solver, const TissueOptions& tissue) {
  fem::NewtonOptions options;
  options.absolute_tolerance_n = rest_tolerance_n(tissue);
  options.relative_tolerance = solver.relative_tolerance;
  options.max_iterations = solver.max_iterations;
  return options;
}

fem::LoadStepOptions load_step_options(const SolverOptions& solver, double increment) {
  fem::LoadStepOptions options;
  options.first_increment = increment;
  options.max_increment = increment;
  options.min_increment = solver.min_increment_ratio * increment;
  return options;
}

}  // namespace lefort::predict
