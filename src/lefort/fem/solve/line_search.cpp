#include <lefort/fem/solve/line_search.h>
#include <lefort/fem/solve/newton_constants.h>

#include <algorithm>
#include <utility>

namespace lefort::fem::internal {
namespace {

/// \param expected_mj  first-order change of the energy; negative for a descent.
/// \returns whether the decrease of the energy, or of |r|, is sufficient.
bool is_sufficient(const NewtonState& from, const NewtonState& to, double expected_mj,
                   const NewtonOptions& options) {
  const double change_mj = to.energy_mj - from.energy_mj;
  const double round_off_mj =
      from.residual_state.energy_round_off_mj + to.residual_state.energy_round_off_mj;
  if (-expected_mj > round_off_mj) return change_mj <= options.sufficient_decrease * expected_mj;
  return to.residual_n < from.residual_n;
}

/// Largest allowed fraction of dx.
double first_length(const NewtonState& from, const VectorX& dx, const NewtonOptions& options) {
  return options.max_step_length ? options.max_step_length(from.x, dx) : 1.0;
}

}  // namespace

std::optional<Step> backtrack(const NonlinearSystem& system, const NewtonState& from,
                              const VectorX& dx, const NewtonOptions& options) {
  const double slope_mj = from.residual_state.residual_n.dot(dx);
  double length = first_length(from, dx, options);
  for (int n = 0; n <= options.max_backtracks; ++n) {
    std::optional<NewtonState> to = evaluate_state(system, from.x + length * dx, &from);
    if (to && is_sufficient(from, *to, length * slope_mj, options))
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

std::optional<Step> backtrack_nonsymmetric(const NonlinearSystem& system, const NewtonState& from,
                                           const VectorX& dx, const NewtonOptions& options) {
  const double slope_mj = from.residual_state.residual_n.dot(dx);
  double length = first_length(from, dx, options);
  for (int n = 0; n < kNonsymmetricTrials; ++n, length *= kMinContraction) {
    std::optional<NewtonState> to = evaluate_state(system, from.x + length * dx, &from);
    if (!to) continue;
    const double max_residual_n = (1.0 - options.sufficient_decrease * length) * from.residual_n;
    if (to->residual_n <= max_residual_n || is_sufficient(from, *to, length * slope_mj, options))
      return Step{*std::move(to), length};
  }
  return std::nullopt;
}

Step expand_step(const NonlinearSystem& system, const NewtonState& from, const VectorX& dx,
                 Step step, const NewtonOptions& options) {
  const double slope_mj = from.residual_state.residual_n.dot(dx);
  for (int n = 0; n < options.max_backtracks; ++n) {
    const double end_slope_mj = step.to.residual_state.residual_n.dot(dx);
    if (!(end_slope_mj < kSlopeReduction * slope_mj)) break;
    const double factor =
        end_slope_mj <= slope_mj
            ? kMaxExpansion
            : std::clamp(slope_mj / (slope_mj - end_slope_mj), kMinExpansion, kMaxExpansion);
    const double length = factor * step.length;
    if (first_length(from, length * dx, options) < 1.0) break;
    std::optional<NewtonState> to = evaluate_state(system, from.x + length * dx, &from);
    if (!to || to->energy_mj >= step.to.energy_mj ||
        !is_sufficient(from, *to, length * slope_mj, options))
      break;
    step = {*std::move(to), length};
  }
  return step;
}

}  // namespace lefort::fem::internal
