#include <lefort/contact/contact_surface.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/element_state.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/predict/face_body.h>
#include <lefort/predict/interface_supports.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/solver_settings.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/predict/tissue_materials.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace lefort::predict {
namespace {

using NodeList = std::vector<std::int32_t>;

/// Checks the sets of find_tissue_boundary().
///
/// \param bonded  nodes that move with each segment.
Result<void> check_sets(const FaceModel& model, const std::vector<std::string>& names,
                        const std::vector<NodeList>& bonded) {
  for (const char* set : {sets::kMobilizedSegment, sets::kFixed})
    LEFORT_CHECK(model.tissue.node_sets.count(set) > 0);
  LEFORT_CHECK(model.tissue.face_sets.count(sets::kContact) > 0);
  const std::vector<NodeList> on_bone =
      nodes_by_segment(model, model.tissue.node_sets.at(sets::kMobilizedSegment));
  for (std::size_t k = 0; k < names.size(); ++k)
    if (on_bone[k].empty() && bonded[k].empty())
      return fail(ErrorCode::kAnatomyMissing,
                  fmt::format("no soft tissue lies on segment {}", names[k]));
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

}  // namespace

Result<std::unique_ptr<FaceBody>> FaceBody::create(const FaceModel& model,
                                                   std::vector<std::string> names,
                                                   const DistanceQueries& distance_queries_B,
                                                   const PredictionOptions& options,
                                                   Progress& progress) {
  LEFORT_CHECK(names.size() == model.segments.size());
  std::unique_ptr<FaceBody> body(new FaceBody(model, std::move(names), options));
  body->bonded_ = bonded_by_segment(model, options.boundary.interface);
  LEFORT_TRY_VOID(check_sets(model, body->names_, body->bonded_));
  LEFORT_TRY(body->materials_, materials_of(options.tissue));
  LEFORT_TRY(body->elements_, fem::make_element_terms(model.tissue, body->materials_));
  LEFORT_TRY_VOID(body->add_contacts(distance_queries_B, progress));
  if (model.lips.is_separated()) body->lip_surfaces_ = lip_surfaces(model.tissue, model.lips);
  body->update_lips(VectorX::Zero(3 * model.tissue.node_count()));
  LEFORT_TRY(fem::DofMap dofs, body->make_dofs());
  body->make_assembler(std::move(dofs));
  return body;
}

Result<void> FaceBody::add_contacts(const DistanceQueries& distance_queries_B, Progress& progress) {
  const mesh::VolumeMesh& tissue = model_.tissue;
  const bool is_sliding = slides_on_segments(tissue, options_.boundary.interface);
  const auto stationary_faces = tissue.face_sets.find(sets::kStationaryContact);
  const bool slides_on_stationary = stationary_faces != tissue.face_sets.end();
  const bool needs_stationary = slides_on_stationary || slides_on_stationary_bone(model_.interface);
  if (is_sliding || slides_on_stationary)
    stiffness_mpa_per_mm_ = contact_law(options_.contact, options_.tissue).penalty_mpa_per_mm;
  std::vector<contact::RigidObstacle> bones;  // At rest: segments, then stationary bone if needed.
  for (std::size_t k = 0; k < distance_queries_B.size(); ++k) {
    LEFORT_TRY(auto bone_B, replaced_bone_query(model_.segments[k]));
    bones.push_back({distance_queries_B[k], RigidTransform::Identity(), std::move(bone_B)});
  }
  if (needs_stationary) {
    LEFORT_CHECK(model_.stationary_bone);
    LEFORT_TRY(auto distance_query_L,
               bone_distance_query(*model_.stationary_bone, options_.contact.detection));
    LEFORT_TRY_VOID(check_stationary_bone(*distance_query_L, options_.boundary.contact_snap_mm));
    LEFORT_TRY(auto bone_L, replaced_bone_query(*model_.stationary_bone));
    bones.push_back({std::move(distance_query_L), RigidTransform::Identity(), std::move(bone_L)});
  }
  if (options_.contact.integration == contact::Integration::kWeighted) {
    if (is_sliding) add_weighted_contacts(bones, progress);
    if (slides_on_stationary)
      weighted_.add_stationary(tissue, stationary_faces->second, bones.back(), weighted_options());
    add_supports(bones);
    return {};
  }
  segment_contact_count_ = is_sliding ? names_.size() : 0;
  for (std::size_t k = 0; k < segment_contact_count_; ++k) {
    add_contact(bones, k, "segment " + names_[k], tissue.face_sets.at(sets::kContact));
    note_rest_penetration(contacts_[k].rest_penetration_mm(), "segment " + names_[k], progress);
  }
  if (slides_on_stationary)
    add_contact(bones, names_.size(), "stationary bone", stationary_faces->second);
  add_supports(bones);
  return {};
}

contact::WeightedContactTerm::Options FaceBody::weighted_options() const {
  return {.stiffness_mpa_per_mm = stiffness_mpa_per_mm_,
          .contact_snap_mm = options_.boundary.contact_snap_mm,
          .has_sharp_points = false};
}

/// \param bones  segments first.
void FaceBody::add_weighted_contacts(const std::vector<contact::RigidObstacle>& bones,
                                     Progress& progress) {
  weighted_.add_segments(model_.tissue,
                         {bones.begin(), bones.begin() + std::ptrdiff_t(names_.size())},
                         weighted_options());
  note_rest_penetration(weighted_.on_segments->rest_penetration_mm(), "the segments", progress);
}

/// \param bones  segments in the order of the plan, then stationary bone if tissue slides on it.
void FaceBody::add_supports(const std::vector<contact::RigidObstacle>& bones) {
  const std::vector<Vec3>& nodes_L = model_.tissue.nodes_L;
  InterfaceSupports supports = interface_supports(model_.tissue, model_.interface, names_.size(),
                                                  options_.tissue, options_.boundary);
  for (std::size_t k = 0; k < names_.size(); ++k) {
    std::vector<double>& fractions = motion_fractions_.emplace_back();
    for (const contact::NodalSupport& one : supports.on_segments[k])
      fractions.push_back(one.motion_fraction);
    segment_supports_.emplace_back(nodes_L, std::move(supports.on_segments[k]), bones[k]);
  }
  stationary_supports_.emplace_back(
      nodes_L, std::move(supports.on_stationary),
      bones.size() > names_.size() ? bones.back() : contact::RigidObstacle{});
  stationary_supports_.emplace_back(nodes_L, std::move(supports.on_planes),
                                    contact::RigidObstacle{});
}

void FaceBody::add_contact(const std::vector<contact::RigidObstacle>& bones, std::size_t bone,
                           const std::string& name, const std::vector<mesh::Face>& faces) {
  std::vector<contact::RigidObstacle> other_obstacles = bones;
  other_obstacles.erase(other_obstacles.begin() + std::ptrdiff_t(bone));
  contacts_.push_back({model_.tissue.nodes_L,
                       faces,
                       bones[bone],
                       {.name = name,
                        .law = contact_law(options_.contact, options_.tissue),
                        .contact_snap_mm = options_.boundary.contact_snap_mm},
                       other_obstacles});
}

/// Warns if the mesh penetrates a segment at rest by more than the contact tolerance.
void FaceBody::note_rest_penetration(double inside_mm, const std::string& bone,
                                     Progress& progress) {
  rest_penetration_mm_ = std::max(rest_penetration_mm_, inside_mm);
  if (inside_mm > options_.boundary.contact_snap_mm)
    progress.note(
        fmt::format("warning: the tissue mesh penetrates {} by up to {:.2f} mm before it moves, "
                    "more than boundary.contact_snap_mm = {:g} mm",
                    bone, inside_mm, options_.boundary.contact_snap_mm));
}

Result<fem::DofMap> FaceBody::make_dofs() const {
  return fem::DofMap::build(
      model_.tissue.node_count(),
      prescribed_at(std::vector<RigidTransform>(names_.size(), RigidTransform::Identity())));
}

void FaceBody::make_assembler(fem::DofMap dofs) {
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : elements_) terms.push_back(term.get());
  for (const contact::ContactTerm& contact : contacts_) terms.push_back(&contact);
  for (const contact::WeightedContactTerm* weighted : weighted_.terms()) terms.push_back(weighted);
  for (const auto* supports : {&segment_supports_, &stationary_supports_})
    for (const contact::SupportTerm& term : *supports)
      if (term.item_count() > 0) terms.push_back(&term);
  if (lips_) terms.push_back(&*lips_);
  assembler_.emplace(model_.tissue.nodes_L, std::move(dofs), std::move(terms));
}

void FaceBody::update_lips(const VectorX& u) {
  if (!model_.lips.is_separated()) return;
  std::vector<FacingPoint> points =
      face_lips(lip_surfaces_, model_.lips.pairs, contact::displaced(model_.tissue.nodes_L, u));
  if (lips_ && lips_->replace(points)) return;
  lips_.emplace(std::move(points),
                contact_law(options_.contact, options_.tissue).penalty_mpa_per_mm,
                options_.boundary.lip_tone_mpa);
  if (assembler_) make_assembler(assembler_->dofs());
}

std::vector<fem::PrescribedDisplacement> FaceBody::prescribed_at(
    std::span<const RigidTransform> X_LB) const {
  const mesh::VolumeMesh& tissue = model_.tissue;
  auto prescribed = fem::prescribe_zero(tissue.node_sets.at(sets::kFixed));
  for (std::size_t k = 0; k < X_LB.size(); ++k) {
    const auto with_bone = fem::prescribe_rigid_motion(bonded_[k], tissue.nodes_L, X_LB[k]);
    prescribed.insert(prescribed.end(), with_bone.begin(), with_bone.end());
  }
  return prescribed;
}

void FaceBody::set_poses(std::span<const RigidTransform> X_LB) {
  for (std::size_t k = 0; k < segment_contact_count_; ++k) contacts_[k].set_pose(X_LB[k]);
  weighted_.set_poses({X_LB.begin(), X_LB.end()});
  for (std::size_t k = 0; k < segment_supports_.size(); ++k) segment_supports_[k].set_pose(X_LB[k]);
}

void FaceBody::set_equilibrium(const FaceEquilibrium& at) {
  set_poses(at.X_LB);
  update_lips(at.paired_u.size() > 0 ? at.paired_u : at.u);
}

fem::NewtonOutcome FaceBody::solve(const FaceEquilibrium& last,
                                   const std::vector<RigidTransform>& X_LB, const VectorX& start,
                                   linear::LinearSolver& linear_solver, Progress& progress,
                                   const OnBodyIterate& on_iterate) {
  set_poses(X_LB);
  update_lips(last.u);
  const auto solve = [&](const VectorX& from, int max_iterations) {
    return solve_from(X_LB, from, max_iterations, linear_solver, progress, on_iterate);
  };
  if (!weighted_.any()) return solve_with_quadrature(last, start, solve);
  return weighted_.solve(last.X_LB, last.u, X_LB, start, options_.solver.max_iterations, solve);
}

fem::NewtonOutcome FaceBody::approach(const std::vector<RigidTransform>& X_LB, const VectorX& start,
                                      int iterations, linear::LinearSolver& linear_solver) {
  set_poses(X_LB);
  update_lips(start);
  return solve_from(X_LB, start, iterations, linear_solver, Progress::none(), {});
}

fem::NewtonOutcome FaceBody::solve_with_quadrature(
    const FaceEquilibrium& last, const VectorX& start,
    const std::function<fem::NewtonOutcome(const VectorX& from, int max_iterations)>& solve) {
  fem::NewtonOutcome outcome = solve(start, options_.solver.max_iterations);
  if (!outcome.converged()) return outcome;
  const std::vector<Vec3> from_L = contact::displaced(model_.tissue.nodes_L, last.u);
  const std::vector<Vec3> to_L = contact::displaced(model_.tissue.nodes_L, outcome.x);
  for (std::size_t k = 0; k < contacts_.size() && outcome.converged(); ++k) {
    const RigidTransform from_X_LB =
        k < segment_contact_count_ ? last.X_LB[k] : RigidTransform::Identity();
    if (auto why = contacts_[k].rejection_reason(from_X_LB, from_L, to_L)) {
      outcome.stop = fem::NewtonStop::kRejected;
      outcome.reason = *std::move(why);
    }
  }
  if (outcome.converged())
    for (contact::ContactTerm& contact : contacts_) contact.note_clearances(to_L);
  return outcome;
}

fem::NewtonOutcome FaceBody::solve_from(const std::vector<RigidTransform>& X_LB,
                                        const VectorX& start, int max_iterations,
                                        linear::LinearSolver& linear_solver, Progress& progress,
                                        const OnBodyIterate& on_iterate) {
  fem::NewtonOptions newton = newton_options(options_.solver, options_.tissue);
  newton.max_iterations = max_iterations;
  if (weighted_.any())
    newton.max_step_length = [&](const VectorX& u, const VectorX& du) {
      return weighted_.max_step_length(u, du);
    };
  bool is_start = true;
  if (on_iterate)
    newton.on_iterate = [&](const fem::NewtonIterate& line,
                            const fem::ResidualState& residual_state) {
      on_iterate(line, residual_state, std::exchange(is_start, false));
    };
  return fem::find_equilibrium(*assembler_, prescribed_at(X_LB), start, linear_solver, newton,
                               progress);
}

void FaceBody::summarize(const FaceEquilibrium& at, PredictionStep& step) const {
  for (const RigidTransform& X_LB : at.X_LB)
    step.segments.push_back({.X_LB = X_LB, .contact = {}, .supports = {}});
  step.displacement_mm = as_vectors(at.u);
  const std::vector<Vec3> x_L = contact::displaced(model_.tissue.nodes_L, at.u);
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
  step.min_J = min_volume_ratio(model_.tissue, materials_, at.u);
}

std::vector<std::vector<contact::NodalContact>> FaceBody::nodal_contacts(const VectorX& u) const {
  const std::vector<Vec3> x_L = contact::displaced(model_.tissue.nodes_L, u);
  if (weighted_.on_segments) return weighted_.on_segments->at_nodes_by_bone(x_L);
  std::vector<std::vector<contact::NodalContact>> all;
  for (const contact::ContactTerm& contact : segment_contacts())
    all.push_back(contact.at_nodes(x_L));
  return all;
}

}  // namespace lefort::predict
