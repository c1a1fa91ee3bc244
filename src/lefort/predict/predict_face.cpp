#include <lefort/core/check.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/predict/face_body.h>
#include <lefort/predict/load_levels.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/solver_settings.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

/// A prediction in progress: the body, the solver and the steps found so far.
///
/// The stepper refers to this object, which therefore never moves.
class FacePath {
 public:
  /// The body at rest. Arguments must outlive the result. \returns as predict_face().
  [[nodiscard]] static Result<std::unique_ptr<FacePath>> create(
      const FaceModel& model, const std::vector<geometry::RigidPath>& paths,
      const PredictionOptions& options, const PredictionWatch& watch, Progress& progress);

  /// Continues where an earlier run stopped.
  void resume(Restart earlier);

  /// All load levels of the path, ascending.
  [[nodiscard]] const std::vector<LoadLevel>& levels() const { return levels_; }
  [[nodiscard]] bool has_reached(double path_fraction) const {
    return path_fraction <= stepper_->state().t;
  }

  /// \returns as fem::LoadStepper::advance_to().
  [[nodiscard]] Result<void> advance_to(double path_fraction);

  /// Adds the current state to the steps. \pre advance_to() has just reached `path_fraction`.
  void record_step(double path_fraction);
  void save_restart();

  /// What was found before advance_to() failed; or the error, if there is nothing to return.
  [[nodiscard]] Result<FacePrediction> stop_after(const Error& error);

  /// The prediction of the whole path.
  [[nodiscard]] FacePrediction finish();

 private:
  FacePath(const FaceModel& model, const std::vector<geometry::RigidPath>& paths,
           const PredictionOptions& options, const PredictionWatch& watch, Progress& progress)
      : model_(model), paths_(paths), options_(options), watch_(watch), progress_(progress) {}

  void make_stepper(double max_distance_mm);

  [[nodiscard]] fem::NewtonOutcome solve_at(double path_fraction, const VectorX& start);
  /// The equilibrium of a state of the stepper.
  [[nodiscard]] FaceEquilibrium at_level(const fem::LoadState& state) const;
  [[nodiscard]] std::vector<fem::LoadAttempt> take_new_attempts();

  const FaceModel& model_;
  const std::vector<geometry::RigidPath>& paths_;
  const PredictionOptions& options_;
  const PredictionWatch& watch_;
  Progress& progress_;

  std::unique_ptr<FaceBody> body_;
  std::vector<LoadLevel> levels_;
  fem::LoadStepOptions increments_;
  std::optional<fem::LoadStepper> stepper_;
  std::optional<linear::LinearSolver> linear_solver_{std::in_place};
  PredictionIterate iterate_;
  std::size_t recorded_attempts_ = 0;
  Restart restart_;  ///< Its steps are those found so far.
  FacePrediction prediction_;
};

Result<std::unique_ptr<FacePath>> FacePath::create(const FaceModel& model,
                                                   const std::vector<geometry::RigidPath>& paths,
                                                   const PredictionOptions& options,
                                                   const PredictionWatch& watch,
                                                   Progress& progress) {
  LEFORT_CHECK(paths.size() == model.segments.size());
  for (const geometry::RigidPath& path : paths) LEFORT_TRY_VOID(geometry::check_path(path));
  LEFORT_TRY(const DistanceQueries distance_queries_B,
             bone_distance_queries(model.segments, options.contact.detection));
  LEFORT_TRY_VOID(check_query_range(paths, model.segments, distance_queries_B, options.boundary));
  std::unique_ptr<FacePath> path(new FacePath(model, paths, options, watch, progress));
  std::vector<std::string> names;
  for (const geometry::RigidPath& one : paths) names.push_back(one.segment);
  LEFORT_TRY(path->body_,
             FaceBody::create(model, std::move(names), distance_queries_B, options, progress));
  path->prediction_.contact_stiffness_mpa_per_mm = path->body_->penalty_stiffness_mpa_per_mm();
  path->prediction_.rest_penetration_mm = path->body_->rest_penetration_mm();
  double max_distance_mm = std::numeric_limits<double>::infinity();
  for (const auto& distance_query_B : distance_queries_B)
    max_distance_mm = std::min(max_distance_mm, distance_query_B->max_distance_mm());
  path->make_stepper(max_distance_mm);
  path->iterate_.attempt = 0;
  return path;
}

/// \param max_distance_mm  of the segments' distance queries, the smallest.
void FacePath::make_stepper(double max_distance_mm) {
  const int count = increments_of_step(options_.tissue, obstacle_of(model_), paths_,
                                       model_.segments, max_distance_mm);
  levels_ = load_levels(paths_, count);
  increments_ = load_step_options(options_.solver, 1.0 / (count * geometry::steps_of(paths_)));
  stepper_.emplace(
      fem::LoadState{0.0, VectorX::Zero(3 * model_.tissue.node_count())},
      [this](double path_fraction, const VectorX& start) { return solve_at(path_fraction, start); },
      increments_);
}

void FacePath::resume(Restart earlier) {
  restart_ = std::move(earlier);
  body_->set_poses(at_level(restart_.stepper.last).X_LB);
  stepper_.emplace(fem::LoadStepper::resumed(
      restart_.stepper,
      [this](double path_fraction, const VectorX& start) { return solve_at(path_fraction, start); },
      increments_));
}

fem::NewtonOutcome FacePath::solve_at(double path_fraction, const VectorX& start) {
  iterate_.to_fraction = path_fraction;
  ++iterate_.attempt;
  iterate_.iteration = -1;
  OnBodyIterate on_iterate;
  if (watch_.on_iterate)
    on_iterate = [&](const fem::NewtonIterate& line, const fem::ResidualState& residual_state,
                     bool is_start) {
      // As in the history, the start of a solve that continues another is left out.
      if (is_start && iterate_.iteration >= 0) return;
      ++iterate_.iteration;
      iterate_.line = line;
      iterate_.deepest_mm = residual_state.deepest_mm;
      watch_.on_iterate(iterate_);
    };
  return body_->solve(at_level(stepper_->state()), geometry::poses_at(paths_, path_fraction), start,
                      *linear_solver_, progress_, on_iterate);
}

FaceEquilibrium FacePath::at_level(const fem::LoadState& state) const {
  return {geometry::poses_at(paths_, state.t), state.u};
}

Result<void> FacePath::advance_to(double path_fraction) {
  // An iterative solver keeps its state within one load level only, so that results do not depend
  // on earlier ones.
  if (body_->assembler().dofs().free_count() > linear::LinearSolverOptions{}.direct_rows)
    linear_solver_.emplace();
  return stepper_->advance_to(path_fraction, progress_);
}

/// Attempts since the last step.
std::vector<fem::LoadAttempt> FacePath::take_new_attempts() {
  const std::vector<fem::LoadAttempt>& attempts = stepper_->attempts();
  std::vector<fem::LoadAttempt> new_attempts(attempts.begin() + std::ptrdiff_t(recorded_attempts_),
                                             attempts.end());
  recorded_attempts_ = attempts.size();
  iterate_.attempt = 0;
  return new_attempts;
}

void FacePath::record_step(double path_fraction) {
  PredictionStep step;
  step.path_fraction = path_fraction;
  body_->summarize({geometry::poses_at(paths_, path_fraction), stepper_->state().u}, step);
  step.attempts = take_new_attempts();
  const fem::NewtonIterate& last = step.attempts.back().history.back();
  step.residual_n = last.residual_n;
  if (last.residual_reference_n > 0.0)
    step.relative_residual = last.residual_n / last.residual_reference_n;
  restart_.steps.push_back(std::move(step));
  save_restart();  // First: who sees a step can resume after it.
  if (watch_.on_step) watch_.on_step(restart_.steps.back());
  progress_.report(path_fraction);
}

void FacePath::save_restart() {
  if (!watch_.on_restart) return;
  restart_.stepper = stepper_->checkpoint();
  watch_.on_restart(restart_);
}

Result<FacePrediction> FacePath::stop_after(const Error& error) {
  if (error.code == ErrorCode::kCancelled) return tl::unexpected(error);
  if (error.code == ErrorCode::kOutOfMemory)
    return fail(ErrorCode::kOutOfMemory,
                fmt::format("the equations of {} nodes do not fit into memory: set "
                            "tissue.element_size_mm larger than {:g} mm",
                            model_.tissue.node_count(), options_.tissue.element_size_mm));
  prediction_.steps = std::move(restart_.steps);
  prediction_.failure = error;
  prediction_.failed_attempts = take_new_attempts();
  return std::move(prediction_);
}

FacePrediction FacePath::finish() {
  prediction_.steps = std::move(restart_.steps);
  prediction_.nodal_contacts = body_->nodal_contacts(stepper_->state().u);
  return std::move(prediction_);
}

}  // namespace

contact::ContactStatistics PredictionStep::contact() const {
  contact::ContactStatistics all;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const contact::ContactStatistics& one = segments[k].contact;
    all = k == 0 ? one : contact::combine(all, one);
  }
  return all;
}

Result<FacePrediction> predict_face(const FaceModel& model,
                                    const std::vector<geometry::RigidPath>& paths,
                                    const PredictionOptions& options, const PredictionWatch& watch,
                                    Progress& progress, std::optional<Restart> earlier) {
  LEFORT_TRY(const std::unique_ptr<FacePath> path,
             FacePath::create(model, paths, options, watch, progress));
  if (earlier) path->resume(*std::move(earlier));
  for (const auto& [path_fraction, is_step] : path->levels()) {
    if (path->has_reached(path_fraction)) continue;  // By the earlier run.
    if (const Result<void> advanced = path->advance_to(path_fraction); !advanced)
      return path->stop_after(advanced.error());
    if (is_step) path->record_step(path_fraction);
  }
  return path->finish();
}

}  // namespace lefort::predict
