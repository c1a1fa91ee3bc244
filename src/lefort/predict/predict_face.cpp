#include <lefort/core/check.h>
#include <lefort/fem/assemble.h>
#include <lefort/fem/boundary_conditions.h>
#include <lefort/fem/dof_map.h>
#include <lefort/fem/element_state.h>
#include <lefort/fem/element_term.h>
#include <lefort/fem/equilibrium.h>
#include <lefort/fem/linear_solver.h>
#include <lefort/fem/load_steps.h>
#include <lefort/plan/bone_path.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/tissue_boundary.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

using NodeList = std::vector<std::int32_t>;

/// Where equilibrium is sought: at every step, and at every keyframe, which the bone must not cut
/// short.
struct LoadLevel {
  double share;
  bool is_step;
};

std::vector<LoadLevel> load_levels(const plan::BonePath& path) {
  constexpr double kSame = 1e-9;  // Shares; a keyframe at 0.3333333333 is step 1 of 3.
  std::vector<LoadLevel> levels;
  for (int step = 1; step <= path.steps; ++step)
    levels.push_back({double(step) / path.steps, true});
  for (const plan::Keyframe& keyframe : path.keyframes) {
    const bool known = std::any_of(levels.begin(), levels.end(), [&](const LoadLevel& level) {
      return std::abs(level.share - keyframe.at) <= kSame;
    });
    if (!known) levels.push_back({keyframe.at, false});
  }
  std::sort(levels.begin(), levels.end(),
            [](const LoadLevel& a, const LoadLevel& b) { return a.share < b.share; });
  return levels;
}

Result<void> check_sets(const FaceModel& model, const plan::BonePath& path) {
  for (const char* set : {sets::kMovedBone, sets::kFixed})
    LEFORT_CHECK(model.tissue.node_sets.count(set) > 0);
  LEFORT_CHECK(model.tissue.face_sets.count(sets::kContact) > 0);
  if (model.tissue.node_sets.at(sets::kMovedBone).empty())
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("no soft tissue lies on segment {}", path.segment));
  if (model.tissue.node_sets.at(sets::kFixed).empty())
    return fail(ErrorCode::kAnatomyMissing,
                "nothing holds the soft tissue: no cut and no still bone within the region");
  return {};
}

/// Nodes that move with the segment: on it, and held by nothing else.
NodeList attached_nodes(const mesh::VolumeMesh& tissue) {
  const NodeList& on_bone = tissue.node_sets.at(sets::kMovedBone);
  const NodeList& fixed = tissue.node_sets.at(sets::kFixed);
  NodeList attached;
  std::set_difference(on_bone.begin(), on_bone.end(), fixed.begin(), fixed.end(),
                      std::back_inserter(attached));
  return attached;
}

std::vector<Vec3> as_vectors(const VectorX& u) {
  std::vector<Vec3> vectors(std::size_t(u.size() / 3));
  for (std::size_t n = 0; n < vectors.size(); ++n) vectors[n] = u.segment<3>(Index(3 * n));
  return vectors;
}

std::vector<Vec3> moved(const std::vector<Vec3>& nodes_L, const std::vector<Vec3>& by_mm) {
  std::vector<Vec3> x_L(nodes_L.size());
  for (std::size_t n = 0; n < nodes_L.size(); ++n) x_L[n] = nodes_L[n] + by_mm[n];
  return x_L;
}

/// A state that contact refuses makes the stepper take smaller increments.
void accept_or_refuse(contact::ContactTerm& contact, const mesh::VolumeMesh& tissue,
                      fem::NewtonOutcome& outcome) {
  const std::vector<Vec3> x_L = moved(tissue.nodes_L, as_vectors(outcome.x));
  std::optional<std::string> refusal = contact.why_refused(x_L);
  if (!refusal) {
    contact.remember(x_L);
    return;
  }
  outcome.stop = fem::NewtonStop::kRefused;
  outcome.reason = *std::move(refusal);
}

/// Least ratio of an element's volume to its volume at rest.
double smallest_volume_ratio(const mesh::VolumeMesh& tissue, const fem::RegionMaterials& materials,
                             const VectorX& u) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const fem::ElementState& state : fem::element_states(tissue, materials, u))
    smallest = std::min(smallest, state.min_volume_ratio);
  return smallest;
}

/// Residuals below it are those of a body at rest: round-off of forces that are all zero. As a part
/// of Young's modulus times an element's face, so that stiffness of tissue does not matter.
double rest_tolerance_n(const TissueOptions& tissue) {
  constexpr double kPart = 1e-10;
  return kPart * tissue.young_mpa * tissue.element_size_mm * tissue.element_size_mm;
}

fem::NewtonOptions newton_options(const SolverOptions& solver, const TissueOptions& tissue) {
  fem::NewtonOptions options;
  options.absolute_tolerance_n = rest_tolerance_n(tissue);
  options.relative_tolerance = solver.relative_tolerance;
  options.max_iterations = solver.max_iterations;
  return options;
}

fem::LoadStepOptions load_step_options(const SolverOptions& solver, int steps) {
  fem::LoadStepOptions options;
  options.first_increment = 1.0 / steps;
  options.min_increment = solver.smallest_step / steps;
  return options;
}

}  // namespace

Result<void> check_field_reach(const plan::BonePath& path, const geometry::TriangleMesh& segment_B,
                               const field::DistanceField& field_B,
                               const BoundaryOptions& boundary) {
  if (boundary.moved_bone != MovedBone::kContact) return {};
  const double band_mm =
      contact::reach_mm(field_B, field_B.is_smooth() ? contact::Reconstruction::kSmooth
                                                     : contact::Reconstruction::kTrilinear);
  if (!field_B.frame().closed)
    return fail(
        ErrorCode::kMeshInvalid,
        fmt::format("segment {} is an open surface, contact needs a closed one", path.segment));
  if (!(boundary.capture_mm < band_mm))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("boundary.capture_mm is {:g} mm, must be less than the {:.2f} mm that "
                            "the segment's distance field reaches",
                            boundary.capture_mm, band_mm));
  double longest_mm = 0.0, mm_per_share = 0.0, from = 0.0;
  for (const LoadLevel& level : load_levels(path)) {
    const double moved_mm =
        plan::largest_displacement_mm(path, segment_B.vertices, from, level.share);
    longest_mm = std::max(longest_mm, moved_mm);
    mm_per_share = std::max(mm_per_share, moved_mm / (level.share - from));
    from = level.share;
  }
  if (longest_mm < band_mm) return {};
  return fail(ErrorCode::kStepBeyondBand,
              fmt::format("segment {} moves {:.2f} mm in one step, but its distance field reaches "
                          "{:.2f} mm: ask for at least {} steps or a wider field.band_mm",
                          path.segment, longest_mm, band_mm, int(mm_per_share / band_mm) + 1));
}

Result<FacePrediction> predict_face(const FaceModel& model, const plan::BonePath& path,
                                    const PredictionOptions& options,
                                    const std::function<void(const PredictionStep&)>& on_step,
                                    Progress& progress) {
  LEFORT_TRY_VOID(plan::check_path(path));
  LEFORT_TRY_VOID(
      check_field_reach(path, model.segment_B, *model.segment_field_B, options.boundary));
  LEFORT_TRY_VOID(check_sets(model, path));
  const mesh::VolumeMesh& tissue = model.tissue;
  const bool is_contact = options.boundary.moved_bone == MovedBone::kContact;

  LEFORT_TRY(const fem::NeoHookean material,
             fem::NeoHookean::from_young_poisson(options.tissue.young_mpa, options.tissue.poisson));
  const fem::RegionMaterials materials{{0, material}};
  LEFORT_TRY(const auto elements, fem::make_element_terms(tissue, materials));
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : elements) terms.push_back(term.get());

  FacePrediction prediction;
  std::optional<contact::ContactTerm> contact;
  if (is_contact) {
    prediction.contact_stiffness_mpa_per_mm = options.contact.stiffness_factor *
                                              options.tissue.young_mpa /
                                              options.tissue.element_size_mm;
    contact.emplace(tissue.nodes_L, tissue.face_sets.at(sets::kContact),
                    contact::BoneObstacle{model.segment_field_B, RigidTransform::Identity(),
                                          options.contact.reconstruction},
                    contact::ContactTerm::Options{prediction.contact_stiffness_mpa_per_mm,
                                                  options.boundary.capture_mm});
    terms.push_back(&*contact);
    prediction.rest_penetration_mm = contact->rest_penetration_mm();
    if (prediction.rest_penetration_mm > options.boundary.capture_mm)
      progress.note(fmt::format(
          "warning: the tissue's mesh lies up to {:.2f} mm inside the segment before it moves, "
          "deeper than boundary.capture_mm = {:g} mm",
          prediction.rest_penetration_mm, options.boundary.capture_mm));
  }

  const NodeList attached = is_contact ? NodeList{} : attached_nodes(tissue);
  const auto prescribed_at = [&](const RigidTransform& X_LB) {
    auto prescribed = fem::fix(tissue.node_sets.at(sets::kFixed));
    const auto with_bone = fem::move_rigidly(attached, tissue.nodes_L, X_LB);
    prescribed.insert(prescribed.end(), with_bone.begin(), with_bone.end());
    return prescribed;
  };
  LEFORT_TRY(fem::DofMap dofs,
             fem::DofMap::build(tissue.node_count(), prescribed_at(RigidTransform::Identity())));
  const fem::Assembler assembler(tissue.nodes_L, std::move(dofs), terms);

  fem::LinearSolver linear_solver;
  const auto solve_at = [&](double share, const VectorX& start) {
    const RigidTransform X_LB = plan::pose_at(path, share);
    if (contact) contact->set_pose(X_LB);
    fem::NewtonOutcome outcome =
        fem::find_equilibrium(assembler, prescribed_at(X_LB), start, linear_solver,
                              newton_options(options.solver, options.tissue), progress);
    if (contact && outcome.converged()) accept_or_refuse(*contact, tissue, outcome);
    return outcome;
  };
  fem::LoadStepper stepper({0.0, VectorX::Zero(3 * tissue.node_count())}, solve_at,
                           load_step_options(options.solver, path.steps));

  std::size_t attempts_told = 0;
  for (const auto& [share, is_step] : load_levels(path)) {
    const Result<void> advanced = stepper.advance_to(share, progress);
    if (advanced && !is_step) continue;
    const auto& attempts = stepper.attempts();
    std::vector<fem::LoadAttempt> new_attempts(attempts.begin() + std::ptrdiff_t(attempts_told),
                                               attempts.end());
    attempts_told = attempts.size();
    if (!advanced) {
      if (advanced.error().code == ErrorCode::kCancelled) return tl::unexpected(advanced.error());
      if (advanced.error().code == ErrorCode::kOutOfMemory)
        return fail(ErrorCode::kOutOfMemory,
                    fmt::format("the equations of {} nodes do not fit into memory: ask for a "
                                "larger tissue.element_size_mm than {:g} mm",
                                tissue.node_count(), options.tissue.element_size_mm));
      prediction.failure = advanced.error();
      prediction.failed_attempts = std::move(new_attempts);
      return prediction;
    }

    PredictionStep result;
    result.share = share;
    result.X_LB = plan::pose_at(path, share);
    result.displacement_mm = as_vectors(stepper.state().u);
    if (contact) result.contact = contact->summarise(moved(tissue.nodes_L, result.displacement_mm));
    result.smallest_J = smallest_volume_ratio(tissue, materials, stepper.state().u);
    const fem::NewtonIterate& last = new_attempts.back().history.back();
    result.residual_n = last.residual_n;
    if (last.force_scale_n > 0.0) result.relative_residual = last.residual_n / last.force_scale_n;
    result.attempts = std::move(new_attempts);
    if (on_step) on_step(result);
    progress.report(share);
    prediction.steps.push_back(std::move(result));
  }
  return prediction;
}

}  // namespace lefort::predict
