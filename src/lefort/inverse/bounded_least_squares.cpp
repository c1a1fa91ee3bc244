#include <lefort/core/check.h>
#include <lefort/inverse/bounded_least_squares.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace lefort::inverse {
namespace {

constexpr double kMinRatio = 1e-4;  ///< Of the decrease to that of the model.
constexpr double kGood = 0.75, kBad = 0.25, kFactor = 4.0;
constexpr double kFirstDamping = 1e-3;  ///< Of the largest diagonal entry of H.
constexpr double kMinDamping = 1e-9, kMaxDamping = 1e6;
constexpr double kSmallGradient = 1e-3;  ///< Of the projected gradient at the start.

/// Components that may change: not at a bound that g points out of.
std::vector<Index> free_components(const VectorX& x, const VectorX& g, const VectorX& lower,
                                   const VectorX& upper) {
  std::vector<Index> free;
  for (Index i = 0; i < x.size(); ++i)
    if (!(x[i] <= lower[i] && g[i] > 0.0) && !(x[i] >= upper[i] && g[i] < 0.0)) free.push_back(i);
  return free;
}

double largest(const VectorX& g, const std::vector<Index>& free) {
  double max = 0.0;
  for (const Index i : free) max = std::max(max, std::abs(g[i]));
  return max;
}

/// Solves (H + mu I) p = -g in the free components, and limits the step.
VectorX damped_step(const QuadraticModel& model, const std::vector<Index>& free, double damping,
                    double max_step) {
  const auto n = Index(free.size());
  Eigen::MatrixXd H(n, n);
  VectorX g(n);
  for (Index a = 0; a < n; ++a) {
    g[a] = model.gradient[free[std::size_t(a)]];
    for (Index b = 0; b < n; ++b)
      H(a, b) = model.hessian(free[std::size_t(a)], free[std::size_t(b)]);
    H(a, a) += damping;
  }
  VectorX of_free = H.ldlt().solve(-g);
  const double length = of_free.lpNorm<Eigen::Infinity>();
  if (length > max_step) of_free *= max_step / length;
  VectorX p = VectorX::Zero(model.gradient.size());
  for (Index a = 0; a < n; ++a) p[free[std::size_t(a)]] = of_free[a];
  return p;
}

/// mu after a trial point.
double next_damping(double damping, double ratio, double scale) {
  if (ratio > kGood) return std::max(damping / kFactor, kMinDamping * scale);
  return ratio < kBad ? damping * kFactor : damping;
}

/// Bounds at which the gradient points out.
void note_active_bounds(const VectorX& lower, const VectorX& upper, LeastSquaresResult& result) {
  for (Index i = 0; i < lower.size(); ++i) {
    result.at_lower.push_back(result.x[i] <= lower[i] && result.model.gradient[i] > 0.0);
    result.at_upper.push_back(result.x[i] >= upper[i] && result.model.gradient[i] < 0.0);
  }
}

/// After a rejected point a step may be small because of the damping.
LeastSquaresStop stop_of_small_step(const LeastSquaresResult& result,
                                    const std::vector<Index>& free) {
  const bool is_minimum = result.history.size() == 1 || result.history.back().is_accepted ||
                          largest(result.model.gradient, free) <=
                              kSmallGradient * result.history.front().projected_gradient;
  return is_minimum ? LeastSquaresStop::kConverged : LeastSquaresStop::kNoDecrease;
}

bool is_final(ErrorCode code) {
  return code == ErrorCode::kCancelled || code == ErrorCode::kOutOfMemory;
}

}  // namespace

Result<LeastSquaresResult> minimize_least_squares(LeastSquaresFunction& function,
                                                  const VectorX& start, const VectorX& lower,
                                                  const VectorX& upper,
                                                  const LeastSquaresOptions& options,
                                                  Progress& progress) {
  LEFORT_CHECK((lower.array() <= start.array()).all() && (start.array() <= upper.array()).all());
  LeastSquaresResult result;
  result.x = start;
  LEFORT_TRY(result.objective, function.evaluate(start));
  function.accept();
  LEFORT_TRY(result.model, function.linearize());
  double damping = kFirstDamping * result.model.hessian.diagonal().maxCoeff();
  std::vector<Index> free = free_components(start, result.model.gradient, lower, upper);
  result.history.push_back({.objective = result.objective,
                            .projected_gradient = largest(result.model.gradient, free),
                            .damping = damping,
                            .x = start});
  const double scale = std::max(result.model.hessian.diagonal().maxCoeff(), 1e-12);
  result.stop = LeastSquaresStop::kTooManyIterations;
  for (int n = 0; n < options.max_iterations; ++n) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "cancelled");
    if (free.empty() || largest(result.model.gradient, free) <= options.gradient_tolerance) {
      result.stop = LeastSquaresStop::kConverged;
      break;
    }
    const VectorX p = damped_step(result.model, free, damping, options.max_step);
    const VectorX x = (result.x + p).cwiseMax(lower).cwiseMin(upper);
    const VectorX step = x - result.x;
    const double length = step.lpNorm<Eigen::Infinity>();
    const double expected =
        -(result.model.gradient.dot(step) + 0.5 * step.dot(result.model.hessian * step));
    if (length <= options.step_tolerance) {
      result.stop = stop_of_small_step(result, free);
      break;
    }
    const Result<double> objective = function.evaluate(x);
    if (!objective && is_final(objective.error().code)) return tl::unexpected(objective.error());
    const double ratio =
        objective && expected > 0.0 ? (result.objective - *objective) / expected : -1.0;
    const bool is_accepted = ratio > kMinRatio;
    const double shown = objective ? *objective : result.objective;
    result.history.push_back({shown, 0.0, length, damping, is_accepted, x});
    damping = next_damping(damping, ratio, scale);
    if (is_accepted) {
      result.x = x;
      result.objective = *objective;
      function.accept();
      LEFORT_TRY(result.model, function.linearize());
      free = free_components(x, result.model.gradient, lower, upper);
    }
    result.history.back().projected_gradient = largest(result.model.gradient, free);
    if (damping > kMaxDamping * scale) {
      result.stop = LeastSquaresStop::kNoDecrease;
      break;
    }
  }
  note_active_bounds(lower, upper, result);
  return result;
}

}  // namespace lefort::inverse
