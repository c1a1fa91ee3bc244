#include <lefort/core/check.h>
#include <lefort/inverse/face_objective.h>

#include <algorithm>
#include <utility>

namespace lefort::inverse {
namespace {

/// Relative to the largest component, or to `smallest` if that is larger: the round-off of a part
/// that is zero is no error.
double relative_difference(const VectorX& gradient, const VectorX& differences, double smallest) {
  const double scale = std::max(differences.lpNorm<Eigen::Infinity>(), smallest);
  return scale > 0.0 ? (gradient - differences).lpNorm<Eigen::Infinity>() / scale : 0.0;
}

}  // namespace

FaceObjective::FaceObjective(LiveFace& face, const MotionProblem& problem, predict::FaceState start,
                             Progress& progress)
    : face_(face),
      problem_(problem),
      start_(std::move(start)),
      progress_(progress),
      correction_mm_(problem.observer.skin_L().vertices.size(), Vec3::Zero()) {}

Result<FaceAt> FaceObjective::solve(const VectorX& x, const predict::FaceState& from) {
  FaceAt face;
  face.x = x;
  const std::vector<RigidTransform> X_LB = problem_.variables.poses(x);
  LEFORT_TRY(face.state, face_.response->solve(X_LB, from, progress_));
  face.skin_mm = predict::skin_displacement(face_.embedding, face.state.displacement_mm());
  for (std::size_t v = 0; v < face.skin_mm.size(); ++v) face.skin_mm[v] += correction_mm_[v];
  face.observations = problem_.observer.observe(face.skin_mm);
  face.target_objective = objective_mm2(face.observations);
  face.objective = face.target_objective;
  for (const OverlapRow& row : problem_.clearance.rows(X_LB, {}))
    face.objective += 0.5 * overlap_weight_ * row.excess_mm * row.excess_mm;
  face.objective += 0.5 * problem_.regularization * (x - problem_.variables.start()).squaredNorm();
  return face;
}

Result<double> FaceObjective::evaluate(const VectorX& x) {
  LEFORT_TRY(trial_, solve(x, present_ ? present_->state : start_));
  return trial_->objective;
}

void FaceObjective::accept() {
  LEFORT_CHECK(trial_);
  present_ = std::move(trial_);
  trial_.reset();
}

Result<QuadraticModel> FaceObjective::linearize() {
  LEFORT_CHECK(present_);
  const VectorX& x = present_->x;
  const Index count = problem_.variables.count();
  const std::vector<predict::PoseRate> rates = problem_.variables.rates(x);
  LEFORT_TRY(const Eigen::MatrixXd du, face_.response->sensitivities(present_->state, rates));
  std::vector<std::vector<Vec3>> skin(std::size_t(count), std::vector<Vec3>{});
  for (Index n = 0; n < count; ++n) {
    std::vector<Vec3> nodes(std::size_t(du.rows() / 3));
    for (std::size_t a = 0; a < nodes.size(); ++a) nodes[a] = du.block<3, 1>(3 * Index(a), n);
    skin[std::size_t(n)] = predict::skin_displacement(face_.embedding, nodes);
  }
  QuadraticModel model{VectorX::Zero(count), Eigen::MatrixXd::Zero(count, count)};
  target_gradients_ = Eigen::MatrixXd::Zero(Index(problem_.observer.target().count()), count);
  VectorX row(count);
  for (const Observation& one : present_->observations) {
    for (Index n = 0; n < count; ++n) {
      row[n] = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        row[n] += one.gradient[k].dot(skin[std::size_t(n)][std::size_t(one.vertices[k])]);
    }
    target_gradients_.row(Index(one.target)) += one.weight * one.residual_mm * row;
    model.gradient += one.weight * one.residual_mm * row;
    model.hessian += one.weight * row * row.transpose();
  }
  target_hessian_ = model.hessian;
  for (const OverlapRow& overlap : problem_.clearance.rows(problem_.variables.poses(x), rates)) {
    model.gradient += overlap_weight_ * overlap.excess_mm * overlap.derivative;
    model.hessian += overlap_weight_ * overlap.derivative * overlap.derivative.transpose();
  }
  model.gradient += problem_.regularization * (x - problem_.variables.start());
  model.hessian.diagonal().array() += problem_.regularization;
  return model;
}

Result<double> FaceObjective::gradient_error(const VectorX& gradient, double step) {
  LEFORT_CHECK(present_ && step > 0.0);
  const VectorX of_targets = target_gradients_.colwise().sum();
  VectorX target_differences(gradient.size()), other_differences(gradient.size());
  for (Index n = 0; n < gradient.size(); ++n) {
    VectorX low = present_->x, high = present_->x;
    low[n] -= step;
    high[n] += step;
    LEFORT_TRY(const FaceAt before, solve(low, present_->state));
    LEFORT_TRY(const FaceAt after, solve(high, present_->state));
    target_differences[n] = (after.target_objective - before.target_objective) / (2.0 * step);
    other_differences[n] =
        (after.objective - before.objective) / (2.0 * step) - target_differences[n];
  }
  constexpr double kSmallest = 1e-3;  // Of the whole gradient.
  const double smallest = kSmallest * gradient.lpNorm<Eigen::Infinity>();
  return std::max(relative_difference(of_targets, target_differences, 0.0),
                  relative_difference(gradient - of_targets, other_differences, smallest));
}

}  // namespace lefort::inverse
