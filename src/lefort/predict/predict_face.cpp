#include <lefort/fem/assemble.h>
#include <lefort/fem/boundary_conditions.h>
#include <lefort/fem/dof_map.h>
#include <lefort/fem/element_term.h>
#include <lefort/fem/equilibrium.h>
#include <lefort/fem/linear_solver.h>
#include <lefort/fem/load_steps.h>
#include <lefort/plan/bone_path.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/tissue_boundary.h>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

using NodeList = std::vector<std::int32_t>;

/// The field must see how deep tissue is once the bone has moved by a step.
Result<void> check_step_against_band(const FaceModel& model, const plan::BonePath& path) {
  const double band_mm = model.segment_field_B->band_mm();
  double longest_mm = 0.0;
  for (int step = 0; step < path.steps; ++step)
    longest_mm = std::max(longest_mm, plan::largest_displacement_mm(path, model.segment_B.vertices,
                                                                    double(step) / path.steps,
                                                                    double(step + 1) / path.steps));
  if (longest_mm < band_mm) return {};
  return fail(
      ErrorCode::kStepBeyondBand,
      fmt::format("segment {} moves {:.2f} mm in one step, but its distance field reaches "
                  "{:.2f} mm: ask for at least {} steps or a wider field.band_mm",
                  path.segment, longest_mm, band_mm, int(longest_mm * path.steps / band_mm) + 1));
}

Result<void> check_sets(const FaceModel& model, const plan::BonePath& path) {
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

/// Least ratio of an element's volume to its volume at rest.
double smallest_volume_ratio(const mesh::VolumeMesh& tissue, const std::vector<Vec3>& x_L) {
  const auto six_volumes = [](const std::vector<Vec3>& x, const std::int32_t* n) {
    const auto at = [&](int corner) -> const Vec3& { return x[std::size_t(n[corner])]; };
    return (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0));
  };
  double smallest = std::numeric_limits<double>::infinity();
  for (const mesh::ElementBlock& block : tissue.blocks)
    for (Index e = 0; e < block.element_count(); ++e)
      smallest = std::min(smallest, six_volumes(x_L, block.element(e)) /
                                        six_volumes(tissue.nodes_L, block.element(e)));
  return smallest;
}

fem::NewtonOptions newton_options(const SolverOptions& solver) {
  fem::NewtonOptions options;
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

Result<FacePrediction> predict_face(const FaceModel& model, const plan::BonePath& path,
                                    const PredictionOptions& options,
                                    const std::function<void(const PredictionStep&)>& on_step,
                                    Progress& progress) {
  LEFORT_TRY_VOID(plan::check_path(path));
  LEFORT_TRY_VOID(check_step_against_band(model, path));
  LEFORT_TRY_VOID(check_sets(model, path));
  const mesh::VolumeMesh& tissue = model.tissue;
  const bool is_contact = options.boundary.moved_bone == MovedBone::kContact;

  LEFORT_TRY(const fem::NeoHookean material,
             fem::NeoHookean::from_young_poisson(options.tissue.young_mpa, options.tissue.poisson));
  LEFORT_TRY(const auto elements, fem::make_element_terms(tissue, {{0, material}}));
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : elements) terms.push_back(term.get());

  FacePrediction prediction;
  prediction.contact_stiffness_mpa_per_mm =
      options.contact.stiffness_factor * options.tissue.young_mpa / options.tissue.element_size_mm;
  ContactTerm contact(
      tissue.nodes_L, tissue.face_sets.at(sets::kContact),
      {model.segment_field_B, RigidTransform::Identity(), options.contact.reconstruction},
      {prediction.contact_stiffness_mpa_per_mm, options.boundary.capture_mm});
  if (is_contact) {
    terms.push_back(&contact);
  } else {
    prediction.contact_stiffness_mpa_per_mm = 0.0;
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
    contact.set_pose(X_LB);
    return fem::find_equilibrium(assembler, prescribed_at(X_LB), start, linear_solver,
                                 newton_options(options.solver), progress);
  };
  fem::LoadStepper stepper({0.0, VectorX::Zero(3 * tissue.node_count())}, solve_at,
                           load_step_options(options.solver, path.steps));

  std::size_t attempts_told = 0;
  for (int step = 1; step <= path.steps; ++step) {
    const double share = double(step) / path.steps;
    const Result<void> advanced = stepper.advance_to(share, progress);
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
    const std::vector<Vec3> x_L = moved(tissue.nodes_L, result.displacement_mm);
    contact.set_pose(result.X_LB);
    if (is_contact) result.contact = contact.summarise(x_L);
    result.smallest_J = smallest_volume_ratio(tissue, x_L);
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
