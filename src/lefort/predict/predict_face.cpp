#include <lefort/contact/solve_augmented_lagrangian.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/element_state.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/predict/interface_supports.h>
#include <lefort/predict/lip_contact.h>
#include <lefort/predict/load_levels.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/solver_settings.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/predict/tissue_materials.h>
#include <lefort/predict/weighted_contacts.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

using NodeList = std::vector<std::int32_t>;

/// Checks the sets of find_tissue_boundary().
///
/// \param bonded  nodes that move with each segment.
Result<void> check_sets(const FaceModel& model, const std::vector<geometry::RigidPath>& paths,
                        const std::vector<NodeList>& bonded) {
  for (const char* set : {sets::kMobilizedSegment, sets::kFixed})
    LEFORT_CHECK(model.tissue.node_sets.count(set) > 0);
  LEFORT_CHECK(model.tissue.face_sets.count(sets::kContact) > 0);
  const std::vector<NodeList> on_bone =
      nodes_by_segment(model, model.tissue.node_sets.at(sets::kMobilizedSegment));
  for (std::size_t k = 0; k < paths.size(); ++k)
    if (on_bone[k].empty() && bonded[k].empty())
      return fail(ErrorCode::kAnatomyMissing,
                  fmt::format("no soft tissue lies on segment {}", paths[k].segment));
  if (model.tissue.node_sets.at(sets::kFixed).empty())
    return fail(
        ErrorCode::kAnatomyMissing,
        "the soft tissue is not fixed anywhere: no cut and no stationary bone in the region");
  return {};
}

std::vector<Vec3> as_vectors(const VectorX& u) {
  std::vector<Vec3> vectors(std::size_t(u.size() / 3));
  for (std::size_t n = 0; n < vectors.size(); ++n) vectors[n] = u.segment<3>(Index(3 * n));
  return vectors;
}

/// Smallest Jacobian of an element.
double min_volume_ratio(const mesh::VolumeMesh& tissue, const fem::RegionMaterials& materials,
                        const VectorX& u) {
  double minimum = std::numeric_limits<double>::infinity();
  for (const fem::ElementState& state : fem::element_states(tissue, materials, u))
    minimum = std::min(minimum, state.min_volume_ratio);
  return minimum;
}

/// A prediction in progress: the body, its contacts, the solver and the steps found so far.
///
/// The assembler points to elements and contacts of this object, which therefore never moves.
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

  [[nodiscard]] Result<void> add_contacts(const DistanceQueries& distance_queries_B);
  void add_contact(const std::vector<contact::RigidObstacle>& bones, std::size_t bone,
                   const std::string& name, const std::vector<mesh::Face>& faces);
  void add_weighted_contacts(const std::vector<contact::RigidObstacle>& bones);
  [[nodiscard]] contact::WeightedContactTerm::Options weighted_options() const;
  void note_rest_penetration(double inside_mm, const std::string& bone);
  void add_supports(const std::vector<contact::RigidObstacle>& bones);
  [[nodiscard]] Result<void> make_assembler();
  void make_stepper(double max_distance_mm);

  [[nodiscard]] std::vector<fem::PrescribedDisplacement> prescribed_at(
      const std::vector<RigidTransform>& X_LB) const;
  void pose_contacts(const std::vector<RigidTransform>& X_LB);
  [[nodiscard]] fem::NewtonOutcome solve_at(double path_fraction, const VectorX& start);
  [[nodiscard]] fem::NewtonOutcome solve_from(const std::vector<RigidTransform>& X_LB,
                                              const VectorX& start, int max_iterations);
  [[nodiscard]] std::vector<fem::LoadAttempt> take_new_attempts();

  const FaceModel& model_;
  const std::vector<geometry::RigidPath>& paths_;
  const PredictionOptions& options_;
  const PredictionWatch& watch_;
  Progress& progress_;

  std::vector<NodeList> bonded_;  ///< Nodes that move with each segment.
  fem::RegionMaterials materials_;
  std::vector<std::unique_ptr<const fem::ForceTerm>> elements_;
  /// With each segment, if tissue slides on them; then with stationary bone, if it slides there.
  std::vector<contact::ContactTerm> contacts_;
  std::size_t segment_contact_count_ = 0;
  WeightedContacts weighted_;
  std::vector<contact::SupportTerm> segment_supports_;     ///< One for each segment.
  std::vector<contact::SupportTerm> stationary_supports_;  ///< On bone and planes.
  std::optional<LipContact> lips_;                         ///< If they are separated.
  std::optional<fem::Assembler> assembler_;

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
  path->bonded_ = bonded_by_segment(model, options.boundary.interface);
  LEFORT_TRY_VOID(check_sets(model, paths, path->bonded_));

  LEFORT_TRY(path->materials_, materials_of(options.tissue));
  LEFORT_TRY(path->elements_, fem::make_element_terms(model.tissue, path->materials_));
  LEFORT_TRY_VOID(path->add_contacts(distance_queries_B));
  LEFORT_TRY_VOID(path->make_assembler());
  double max_distance_mm = std::numeric_limits<double>::infinity();
  for (const auto& distance_query_B : distance_queries_B)
    max_distance_mm = std::min(max_distance_mm, distance_query_B->max_distance_mm());
  path->make_stepper(max_distance_mm);
  path->iterate_.attempt = 0;
  return path;
}

Result<void> FacePath::add_contacts(const DistanceQueries& distance_queries_B) {
  const mesh::VolumeMesh& tissue = model_.tissue;
  const bool is_sliding = options_.boundary.interface != TissueInterface::kBonded ||
                          !nodes_painted(tissue, BoundaryLabel::kContact).empty() ||
                          !nodes_painted(tissue, BoundaryLabel::kElevated).empty();
  const auto stationary_faces = tissue.face_sets.find(sets::kStationaryContact);
  const bool slides_on_stationary = stationary_faces != tissue.face_sets.end();
  const bool needs_stationary = slides_on_stationary || slides_on_stationary_bone(model_.interface);
  if (is_sliding || slides_on_stationary)
    prediction_.contact_stiffness_mpa_per_mm =
        contact_stiffness_mpa_per_mm(options_.tissue, options_.contact);
  std::vector<contact::RigidObstacle> bones;  // At rest: segments, then stationary bone if needed.
  for (const auto& distance_query_B : distance_queries_B)
    bones.push_back({distance_query_B, RigidTransform::Identity()});
  if (needs_stationary) {
    LEFORT_CHECK(model_.stationary_bone);
    LEFORT_TRY(auto distance_query_L,
               bone_distance_query(*model_.stationary_bone, options_.contact.detection));
    LEFORT_TRY_VOID(check_stationary_bone(*distance_query_L, options_.boundary.contact_snap_mm));
    bones.push_back({std::move(distance_query_L), RigidTransform::Identity()});
  }
  if (options_.contact.integration == contact::Integration::kWeighted) {
    if (is_sliding) add_weighted_contacts(bones);
    if (slides_on_stationary)
      weighted_.add_stationary(tissue, stationary_faces->second, bones.back(), weighted_options());
    add_supports(bones);
    return {};
  }
  segment_contact_count_ = is_sliding ? paths_.size() : 0;
  for (std::size_t k = 0; k < segment_contact_count_; ++k) {
    add_contact(bones, k, "segment " + paths_[k].segment, tissue.face_sets.at(sets::kContact));
    note_rest_penetration(contacts_[k].rest_penetration_mm(), "segment " + paths_[k].segment);
  }
  if (slides_on_stationary)
    add_contact(bones, paths_.size(), "stationary bone", stationary_faces->second);
  add_supports(bones);
  return {};
}

contact::WeightedContactTerm::Options FacePath::weighted_options() const {
  return {.stiffness_mpa_per_mm = prediction_.contact_stiffness_mpa_per_mm,
          .contact_snap_mm = options_.boundary.contact_snap_mm,
          .has_sharp_points = false};
}

/// \param bones  segments first.
void FacePath::add_weighted_contacts(const std::vector<contact::RigidObstacle>& bones) {
  weighted_.add_segments(model_.tissue,
                         {bones.begin(), bones.begin() + std::ptrdiff_t(paths_.size())},
                         weighted_options());
  note_rest_penetration(weighted_.on_segments->rest_penetration_mm(), "the segments");
}

/// \param bones  segments in the order of the plan, then stationary bone if tissue slides on it.
void FacePath::add_supports(const std::vector<contact::RigidObstacle>& bones) {
  const std::vector<Vec3>& nodes_L = model_.tissue.nodes_L;
  InterfaceSupports supports = interface_supports(model_.tissue, model_.interface, paths_.size(),
                                                  options_.tissue, options_.boundary);
  for (std::size_t k = 0; k < paths_.size(); ++k)
    segment_supports_.emplace_back(nodes_L, std::move(supports.on_segments[k]), bones[k]);
  stationary_supports_.emplace_back(
      nodes_L, std::move(supports.on_stationary),
      bones.size() > paths_.size() ? bones.back() : contact::RigidObstacle{});
  stationary_supports_.emplace_back(nodes_L, std::move(supports.on_planes),
                                    contact::RigidObstacle{});
}

void FacePath::add_contact(const std::vector<contact::RigidObstacle>& bones, std::size_t bone,
                           const std::string& name, const std::vector<mesh::Face>& faces) {
  std::vector<contact::RigidObstacle> other_obstacles = bones;
  other_obstacles.erase(other_obstacles.begin() + std::ptrdiff_t(bone));
  contacts_.push_back({model_.tissue.nodes_L,
                       faces,
                       bones[bone],
                       {.name = name,
                        .stiffness_mpa_per_mm = prediction_.contact_stiffness_mpa_per_mm,
                        .contact_snap_mm = options_.boundary.contact_snap_mm,
                        .integration = options_.contact.integration,
                        .penetration_tolerance_mm = options_.contact.penetration_tolerance_mm},
                       other_obstacles});
}

/// Warns if the mesh penetrates a segment at rest by more than the contact tolerance.
void FacePath::note_rest_penetration(double inside_mm, const std::string& bone) {
  prediction_.rest_penetration_mm = std::max(prediction_.rest_penetration_mm, inside_mm);
  if (inside_mm > options_.boundary.contact_snap_mm)
    progress_.note(
        fmt::format("warning: the tissue mesh penetrates {} by up to {:.2f} mm before it moves, "
                    "more than boundary.contact_snap_mm = {:g} mm",
                    bone, inside_mm, options_.boundary.contact_snap_mm));
}

Result<void> FacePath::make_assembler() {
  const mesh::VolumeMesh& tissue = model_.tissue;
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : elements_) terms.push_back(term.get());
  for (const contact::ContactTerm& contact : contacts_) terms.push_back(&contact);
  for (const contact::WeightedContactTerm* weighted : weighted_.terms()) terms.push_back(weighted);
  for (const auto* supports : {&segment_supports_, &stationary_supports_})
    for (const contact::SupportTerm& term : *supports)
      if (term.item_count() > 0) terms.push_back(&term);
  if (model_.lips.is_separated())
    terms.push_back(&lips_.emplace(
        model_.lips.pairs, contact_stiffness_mpa_per_mm(options_.tissue, options_.contact)));
  LEFORT_TRY(fem::DofMap dofs, fem::DofMap::build(tissue.node_count(),
                                                  prescribed_at(geometry::poses_at(paths_, 0.0))));
  assembler_.emplace(tissue.nodes_L, std::move(dofs), std::move(terms));
  return {};
}

/// \param max_distance_mm  of the segments' distance queries, the smallest.
void FacePath::make_stepper(double max_distance_mm) {
  const int count = increments_of_step(options_.tissue, paths_, model_.segments, max_distance_mm);
  levels_ = load_levels(paths_, count);
  increments_ = load_step_options(options_.solver, 1.0 / (count * geometry::steps_of(paths_)));
  stepper_.emplace(
      fem::LoadState{0.0, VectorX::Zero(3 * model_.tissue.node_count())},
      [this](double path_fraction, const VectorX& start) { return solve_at(path_fraction, start); },
      increments_);
}

void FacePath::resume(Restart earlier) {
  restart_ = std::move(earlier);
  LEFORT_CHECK(restart_.contacts.size() == contacts_.size());
  const fem::LoadState& last = restart_.stepper.last;
  pose_contacts(geometry::poses_at(paths_, last.t));
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    contacts_[k].restore(restart_.contacts[k], contact::displaced(model_.tissue.nodes_L, last.u));
  stepper_.emplace(fem::LoadStepper::resumed(
      restart_.stepper,
      [this](double path_fraction, const VectorX& start) { return solve_at(path_fraction, start); },
      increments_));
}

std::vector<fem::PrescribedDisplacement> FacePath::prescribed_at(
    const std::vector<RigidTransform>& X_LB) const {
  const mesh::VolumeMesh& tissue = model_.tissue;
  auto prescribed = fem::prescribe_zero(tissue.node_sets.at(sets::kFixed));
  for (std::size_t k = 0; k < X_LB.size(); ++k) {
    const auto with_bone = fem::prescribe_rigid_motion(bonded_[k], tissue.nodes_L, X_LB[k]);
    prescribed.insert(prescribed.end(), with_bone.begin(), with_bone.end());
  }
  return prescribed;
}

void FacePath::pose_contacts(const std::vector<RigidTransform>& X_LB) {
  for (std::size_t k = 0; k < segment_contact_count_; ++k) contacts_[k].set_pose(X_LB[k]);
  weighted_.set_poses(X_LB);
  for (std::size_t k = 0; k < segment_supports_.size(); ++k) segment_supports_[k].set_pose(X_LB[k]);
}

fem::NewtonOutcome FacePath::solve_at(double path_fraction, const VectorX& start) {
  const std::vector<RigidTransform> X_LB = geometry::poses_at(paths_, path_fraction);
  pose_contacts(X_LB);
  iterate_.to_fraction = path_fraction;
  ++iterate_.attempt;
  iterate_.iteration = -1;
  const auto solve = [&](const VectorX& from, int max_iterations) {
    return solve_from(X_LB, from, max_iterations);
  };
  if (!weighted_.any())
    return contact::solve_augmented_lagrangian(
        contacts_, model_.tissue.nodes_L, start,
        [&](const VectorX& from) { return solve(from, options_.solver.max_iterations); });
  return weighted_.solve(geometry::poses_at(paths_, stepper_->state().t), stepper_->state().u, X_LB,
                         start, options_.solver.max_iterations, solve);
}

fem::NewtonOutcome FacePath::solve_from(const std::vector<RigidTransform>& X_LB,
                                        const VectorX& start, int max_iterations) {
  fem::NewtonOptions newton = newton_options(options_.solver, options_.tissue);
  newton.max_iterations = max_iterations;
  if (weighted_.any())
    newton.max_step_length = [&](const VectorX& u, const VectorX& du) {
      return weighted_.max_step_length(u, du);
    };
  // As in the history, the start of a solve that follows a multiplier update is left out.
  bool is_reported = watch_.on_iterate && iterate_.iteration < 0;
  if (watch_.on_iterate)
    newton.on_iterate = [&](const fem::NewtonIterate& line,
                            const fem::ResidualState& residual_state) {
      if (!std::exchange(is_reported, true)) return;
      ++iterate_.iteration;
      iterate_.line = line;
      iterate_.deepest_mm = residual_state.deepest_mm;
      watch_.on_iterate(iterate_);
    };
  return fem::find_equilibrium(*assembler_, prescribed_at(X_LB), start, *linear_solver_, newton,
                               progress_);
}

Result<void> FacePath::advance_to(double path_fraction) {
  // An iterative solver keeps its state within one load level only, so that results do not depend
  // on earlier ones.
  if (assembler_->dofs().free_count() > linear::LinearSolverOptions{}.direct_rows)
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
  const VectorX& u = stepper_->state().u;
  PredictionStep step;
  step.path_fraction = path_fraction;
  for (const RigidTransform& X_LB : geometry::poses_at(paths_, path_fraction))
    step.segments.push_back({.X_LB = X_LB, .contact = {}, .supports = {}});
  step.displacement_mm = as_vectors(u);
  const std::vector<Vec3> x_L = contact::displaced(model_.tissue.nodes_L, u);
  for (std::size_t k = 0; k < segment_contact_count_; ++k)
    step.segments[k].contact = contacts_[k].summarize(x_L);
  if (contacts_.size() > segment_contact_count_)
    step.stationary_contact = contacts_.back().summarize(x_L);
  if (weighted_.on_segments) {
    const std::vector<contact::ContactStatistics> sums = weighted_.on_segments->summarize(x_L);
    for (std::size_t k = 0; k < sums.size(); ++k) step.segments[k].contact = sums[k];
  }
  if (weighted_.on_stationary)
    step.stationary_contact = weighted_.on_stationary->summarize(x_L).front();
  for (std::size_t k = 0; k < segment_supports_.size(); ++k)
    step.segments[k].supports = segment_supports_[k].summarize(x_L);
  if (!stationary_supports_.empty())
    step.stationary_supports = stationary_supports_.front().summarize(x_L);
  step.min_J = min_volume_ratio(model_.tissue, materials_, u);
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
  restart_.contacts.clear();
  for (const contact::ContactTerm& contact : contacts_)
    restart_.contacts.push_back(contact.checkpoint());
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
  for (std::size_t k = 0; k < segment_contact_count_; ++k)
    prediction_.nodal_contacts.push_back(
        contacts_[k].at_nodes(contact::displaced(model_.tissue.nodes_L, stepper_->state().u)));
  if (weighted_.on_segments)
    prediction_.nodal_contacts = weighted_.on_segments->at_nodes_by_bone(
        contact::displaced(model_.tissue.nodes_L, stepper_->state().u));
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

double contact_stiffness_mpa_per_mm(const TissueOptions& tissue, const ContactOptions& contact) {
  return stiffness_factor(contact, tissue) * tissue.young_mpa / node_spacing_mm(tissue);
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
