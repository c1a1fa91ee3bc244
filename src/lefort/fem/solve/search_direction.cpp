#include <lefort/fem/solve/newton_constants.h>
#include <lefort/fem/solve/search_direction.h>
#include <lefort/linear/gmres.h>

#include <algorithm>
#include <utility>

namespace lefort::fem::internal {
namespace {

/// \returns (1 - beta) K + beta K_stable, both of one pattern.
linear::SparseMatrix blended(const linear::SparseMatrix& K, const linear::SparseMatrix& K_stable,
                             double beta) {
  linear::SparseMatrix sum = K;
  sum.coeffs() += beta * (K_stable.coeffs() - K.coeffs());
  return sum;
}

/// \returns K + tau D, where D holds the magnitudes of the diagonal of K, none nearly zero.
linear::SparseMatrix shifted(const linear::SparseMatrix& K, double tau) {
  const VectorX diagonal = K.diagonal().cwiseAbs();
  const VectorX D = diagonal.cwiseMax(kMinDiagonal * diagonal.mean());
  linear::SparseMatrix sum = K;
  sum.diagonal() += tau * D;
  return sum;
}

/// \returns the tangent to try after `model`, which was not positive definite.
/// \param last  of the previous step.
TangentModel next_model(TangentModel model, const TangentModel& last) {
  if (model.tangent_blend == 0.0) {
    const double beta =
        last.is_step_short ? last.tangent_blend * kBlendGrowth : last.tangent_blend / kBlendGrowth;
    model.tangent_blend = std::clamp(beta, kFirstBlend, 1.0);
  } else if (model.tangent_blend < 1.0) {
    model.tangent_blend = std::min(model.tangent_blend * kBlendGrowth, 1.0);
  } else {
    model.diagonal_shift = model.diagonal_shift > 0.0
                               ? model.diagonal_shift * kShiftGrowth
                               : std::max(kFirstShift, last.diagonal_shift / kShiftGrowth);
  }
  return model;
}

/// \returns whether there is more in A than round-off.
bool is_unsymmetric(const linear::SparseMatrix& K, const linear::SparseMatrix& A) {
  return A.nonZeros() > 0 &&
         A.coeffs().abs().maxCoeff() > kAntisymmetricRoundOff * K.coeffs().abs().maxCoeff();
}

NewtonStop stop_of(linear::LinearSolveStatus status) {
  switch (status) {
    case linear::LinearSolveStatus::kOutOfMemory:
      return NewtonStop::kOutOfMemory;
    case linear::LinearSolveStatus::kNotConverged:
      return NewtonStop::kLinearNotConverged;
    default:
      return NewtonStop::kSingularTangent;
  }
}

}  // namespace

DirectionFinder::Solution DirectionFinder::solve(const linear::SparseMatrix& K,
                                                 const Equations& equations) {
  enter(SolvePhase::kFactorization, options_);
  auto dx = solver_.solve(K, equations.b, equations.tolerance,
                          [&] { enter(SolvePhase::kSolve, options_); });
  enter(SolvePhase::kAssembly, options_);
  return dx;
}

std::optional<VectorX> DirectionFinder::solve_unsymmetric(const Equations& equations) {
  const linear::SparseMatrix& K = equations.K;
  const linear::SparseMatrix& A = equations.A;
  const auto multiply = [&](const VectorX& x) {
    VectorX y = K.selfadjointView<Eigen::Lower>() * x;
    y += A * x;
    y -= A.transpose() * x;
    return y;
  };
  const auto precondition = [&](const VectorX& r) -> std::optional<VectorX> {
    auto z = solver_.solve(r, kPreconditionerTolerance);
    if (!z) return std::nullopt;
    return *std::move(z);
  };
  enter(SolvePhase::kSolve, options_);
  auto found =
      linear::solve_by_gmres(multiply, precondition, equations.b,
                             kGmresToleranceFactor * equations.tolerance, kMaxGmresIterations);
  enter(SolvePhase::kAssembly, options_);
  if (!found || found->relative_residual > kMaxGmresResidual) return std::nullopt;
  return std::move(found->x);
}

tl::expected<SearchDirection, NewtonStop> DirectionFinder::find(const NewtonState& at,
                                                                const TangentModel& last,
                                                                double tolerance) {
  const Equations equations{.K = system_.tangent(at.x, Tangent::kExact),
                            .A = system_.antisymmetric_tangent(at.x),
                            .b = -at.residual_state.residual_n,
                            .tolerance = tolerance};
  TangentModel model;
  linear::SparseMatrix K_stable;
  Solution dx = solve(equations.K, equations);
  while (!dx && dx.error() == linear::LinearSolveStatus::kNotPositiveDefinite) {
    if (progress_.stop_requested()) return tl::unexpected(NewtonStop::kCancelled);
    if (model.tangent_blend == 0.0) K_stable = system_.tangent(at.x, Tangent::kStabilized);
    model = next_model(model, last);
    if (model.diagonal_shift > options_.max_diagonal_shift) break;
    dx = solve(model.diagonal_shift > 0.0 ? shifted(K_stable, model.diagonal_shift)
                                          : blended(equations.K, K_stable, model.tangent_blend),
               equations);
  }
  if (!dx) return tl::unexpected(stop_of(dx.error()));
  SearchDirection direction{*std::move(dx), model};
  if (is_unsymmetric(equations.K, equations.A))
    direction.unsymmetric_dx = solve_unsymmetric(equations);
  return direction;
}

}  // namespace lefort::fem::internal
