#include <lefort/fem/solve/newton_state.h>

#include <cmath>
#include <utility>

namespace lefort::fem::internal {

std::optional<NewtonState> evaluate_state(const NonlinearSystem& system, VectorX x,
                                          const NewtonState* from) {
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

}  // namespace lefort::fem::internal
