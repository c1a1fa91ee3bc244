#include <lefort/fem/solve/newton_constants.h>
#include <lefort/fem/solve/newton_convergence.h>

#include <algorithm>

namespace lefort::fem::internal {

double tolerance_n(const NewtonState& at, const NewtonOptions& options) {
  return std::max(options.relative_tolerance * at.residual_state.residual_reference_n,
                  options.absolute_tolerance_n);
}

bool is_round_off(const NewtonState& at, const NewtonOptions& options) {
  if (options.round_off_n.size() == 0) return false;
  const VectorX excess =
      (at.residual_state.residual_n.cwiseAbs() - options.round_off_n).cwiseMax(0.0);
  return excess.norm() <= options.relative_tolerance * at.residual_state.residual_reference_n;
}

bool is_converged(const NewtonState& at, int iterations, const NewtonOptions& options) {
  if (at.residual_n <= tolerance_n(at, options)) return true;
  const bool may_be_round_off =
      options.may_accept_start_by_round_off || iterations > 0 ||
      at.residual_n <= kMaxRoundOffFraction * at.residual_state.residual_reference_n;
  return may_be_round_off && is_round_off(at, options);
}

int StagnationMonitor::stalled_steps(const NewtonState& from, const NewtonState& to,
                                     bool is_shifted) {
  const double gain_mj = from.energy_mj - to.energy_mj;
  const double gain_so_far_mj = first_energy_mj_ - from.energy_mj;
  const double min_gain_mj = std::max(kRoundOffMultiple * to.residual_state.energy_round_off_mj,
                                      is_shifted ? kShiftedGainFraction * gain_so_far_mj : 0.0);
  const bool is_residual_lower = to.residual_n < kResidualReduction * min_residual_n_;
  min_residual_n_ = std::min(min_residual_n_, to.residual_n);
  return stalled_ = gain_mj > min_gain_mj || is_residual_lower ? 0 : stalled_ + 1;
}

double EisenstatWalkerTolerance::next(double residual_n, double converged_n) {
  const double ratio = last_residual_n_ > 0.0 ? residual_n / last_residual_n_ : 1.0;
  last_residual_n_ = residual_n;
  const double sufficient =
      residual_n > 0.0 ? kOversolvingFraction * converged_n / residual_n : max_;
  return std::clamp(ratio * ratio, std::clamp(sufficient, min_, max_), max_);
}

}  // namespace lefort::fem::internal
