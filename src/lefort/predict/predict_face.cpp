#include <lefort/contact/solve_augmented_lagrangian.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/element_state.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/predict/tissue_materials.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

using NodeList = std::vector<std::int32_t>;

/// Where equilibrium is sought: at every increment, and at every keyframe, which no bone must cut
/// short.
struct LoadLevel {
  double path_fraction;
  bool is_step;
};

/// \param increments  of a step. Six steps of four have the levels of 24 steps of one, bit by bit:
///   division rounds equal ratios alike.
std::vector<LoadLevel> load_levels(const std::vector<geometry::RigidPath>& paths, int increments) {
  constexpr double kSame = 1e-9;  // Shares; a keyframe at 0.3333333333 is step 1 of 3.
  const int count = increments * geometry::steps_of(paths);
  std::vector<LoadLevel> levels;
  for (int n = 1; n <= count; ++n) levels.push_back({double(n) / count, n % increments == 0});
  for (const geometry::RigidPath& path : paths)
    for (const geometry::Keyframe& keyframe : path.keyframes) {
      const bool known = std::any_of(levels.begin(), levels.end(), [&](const LoadLevel& level) {
        return std::abs(level.path_fraction - keyframe.at) <= kSame;
      });
      if (!known) levels.push_back({keyframe.at, false});
    }
  std::sort(levels.begin(), levels.end(), [](const LoadLevel& a, const LoadLevel& b) {
    return a.path_fraction < b.path_fraction;
  });
  return levels;
}

/// \param attached  to each segment.
Result<void> check_sets(const FaceModel& model, const std::vector<geometry::RigidPath>& paths,
                        const std::vector<NodeList>& attached) {
  for (const char* set : {sets::kMobilizedSegment, sets::kFixed})
    LEFORT_CHECK(model.tissue.node_sets.count(set) > 0);
  LEFORT_CHECK(model.tissue.face_sets.count(sets::kContact) > 0);
  const std::vector<NodeList> on_bone =
      nodes_by_segment(model, model.tissue.node_sets.at(sets::kMobilizedSegment));
  for (std::size_t k = 0; k < paths.size(); ++k)
    if (on_bone[k].empty() && attached[k].empty())
      return fail(ErrorCode::kAnatomyMissing,
                  fmt::format("no soft tissue lies on segment {}", paths[k].segment));
  if (model.tissue.node_sets.at(sets::kFixed).empty())
    return fail(ErrorCode::kAnatomyMissing,
                "nothing holds the soft tissue: no cut and no still bone within the region");
  return {};
}

std::vector<Vec3> as_vectors(const VectorX& u) {
  std::vector<Vec3> vectors(std::size_t(u.size() / 3));
  for (std::size_t n = 0; n < vectors.size(); ++n) vectors[n] = u.segment<3>(Index(3 * n));
  return vectors;
}

/// Least ratio of an element's volume to its volume at rest.
double min_volume_ratio(const mesh::VolumeMesh& tissue, const fem::RegionMaterials& materials,
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

/// How far the fastest segment moves per share of its path, at most.
double speed_mm(const std::vector<geometry::RigidPath>& paths,
                const std::vector<MovedSegment>& segments) {
  double fastest_mm = 0.0;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    double from = 0.0;
    for (const geometry::Keyframe& keyframe : paths[k].keyframes) {
      const double moved_mm = geometry::max_displacement_mm(
          paths[k], segments[k].surface_B.vertices, from, keyframe.at);
      fastest_mm = std::max(fastest_mm, moved_mm / (keyframe.at - from));
      from = keyframe.at;
    }
  }
  return fastest_mm;
}

/// Into how many equal increments a step is cut, so that plans that differ in their number of steps
/// alone come down to increments alike.
int increments_of_step(const PredictionOptions& prediction,
                       const std::vector<geometry::RigidPath>& paths,
                       const std::vector<MovedSegment>& segments, double reach_mm) {
  constexpr double kOfElement = 0.25, kOfReach = 0.5;
  const double max_mm =
      std::min(kOfElement * prediction.tissue.element_size_mm, kOfReach * reach_mm);
  const double step_mm = speed_mm(paths, segments) / geometry::steps_of(paths);
  return int(std::max(std::ceil(step_mm / max_mm - 1e-9), 1.0));
}

/// \param increment  share of the path.
fem::LoadStepOptions load_step_options(const SolverOptions& solver, double increment) {
  fem::LoadStepOptions options;
  options.first_increment = increment;
  options.max_increment = increment;
  options.min_increment = solver.min_increment_ratio * increment;
  return options;
}

using DistanceQuerys = std::vector<std::shared_ptr<const contact::DistanceQuery>>;

Result<DistanceQuerys> detect_all(const std::vector<MovedSegment>& segments,
                                  contact::DetectionMethod detection) {
  DistanceQuerys distance_querys_B;
  for (const MovedSegment& segment : segments) {
    LEFORT_TRY(auto distance_query_B, detect_segment(segment, detection));
    distance_querys_B.push_back(std::move(distance_query_B));
  }
  return distance_querys_B;
}

/// Whether contact with still bone can be told where tissue is painted to slide on it.
Result<void> check_stationary_bone(const contact::DistanceQuery& distance_query_L,
                                   double capture_mm) {
  if (!distance_query_L.is_closed())
    return fail(ErrorCode::kMeshInvalid,
                "the still bone is an open surface, tissue that slides on it needs a closed one");
  if (capture_mm < distance_query_L.max_distance_mm()) return {};
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("boundary.contact_snap_mm is {:g} mm, must be less than the {:.2f} mm that the "
                  "still bone's distance field reaches",
                  capture_mm, distance_query_L.max_distance_mm()));
}

/// Of one segment, see check_reach().
Result<void> check_reach_of(const geometry::RigidPath& path, const std::vector<LoadLevel>& levels,
                            const MovedSegment& segment,
                            const contact::DistanceQuery& distance_query_B, double capture_mm) {
  const double band_mm = distance_query_B.max_distance_mm();
  if (!distance_query_B.is_closed())
    return fail(
        ErrorCode::kMeshInvalid,
        fmt::format("segment {} is an open surface, contact needs a closed one", path.segment));
  if (!(capture_mm < band_mm))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("boundary.contact_snap_mm is {:g} mm, must be less than the {:.2f} mm that "
                    "the segment's distance field reaches",
                    capture_mm, band_mm));
  double longest_mm = 0.0, mm_per_fraction = 0.0, from = 0.0;
  for (const LoadLevel& level : levels) {
    const double moved_mm =
        geometry::max_displacement_mm(path, segment.surface_B.vertices, from, level.path_fraction);
    longest_mm = std::max(longest_mm, moved_mm);
    mm_per_fraction = std::max(mm_per_fraction, moved_mm / (level.path_fraction - from));
    from = level.path_fraction;
  }
  if (longest_mm < band_mm) return {};
  return fail(ErrorCode::kStepBeyondBand,
              fmt::format("segment {} moves {:.2f} mm in one step, but its distance field reaches "
                          "{:.2f} mm: ask for at least {} steps or a wider field.band_mm",
                          path.segment, longest_mm, band_mm, int(mm_per_fraction / band_mm) + 1));
}

Result<void> check_reaches(const std::vector<geometry::RigidPath>& paths,
                           const std::vector<MovedSegment>& segments,
                           const DistanceQuerys& distance_querys_B,
                           const BoundaryOptions& boundary) {
  if (boundary.segment_interface != SegmentInterface::kSliding) return {};
  const std::vector<LoadLevel> levels = load_levels(paths, 1);
  for (std::size_t k = 0; k < paths.size(); ++k)
    LEFORT_TRY_VOID(
        check_reach_of(paths[k], levels, segments[k], *distance_querys_B[k], boundary.capture_mm));
  return {};
}

}  // namespace

Result<std::shared_ptr<const contact::DistanceQuery>> detect_segment(
    const MovedSegment& segment, contact::DetectionMethod detection) {
  if (detection != contact::DetectionMethod::kBvh)
    return contact::field_distance_query(segment.field_B, detection);
  return contact::bvh_distance_query(std::make_shared<const geometry::Bvh>(segment.surface_B),
                                     segment.field_B->band_mm());
}

Result<void> check_reach(const std::vector<geometry::RigidPath>& paths,
                         const std::vector<MovedSegment>& segments,
                         contact::DetectionMethod detection, const BoundaryOptions& boundary) {
  LEFORT_CHECK(paths.size() == segments.size());
  LEFORT_TRY(const DistanceQuerys distance_querys_B, detect_all(segments, detection));
  return check_reaches(paths, segments, distance_querys_B, boundary);
}

contact::ContactStatistics PredictionStep::contact() const {
  contact::ContactStatistics all;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const contact::ContactStatistics& one = segments[k].contact;
    all = k == 0 ? one : contact::combine(all, one);
  }
  return all;
}

double contact_stiffness_mpa_per_mm(const TissueOptions& tissue, const ContactOptions& contact) {
  return stiffness_factor(contact) * tissue.young_mpa / tissue.element_size_mm;
}

Result<FacePrediction> predict_face(const FaceModel& model,
                                    const std::vector<geometry::RigidPath>& paths,
                                    const PredictionOptions& options, const PredictionWatch& watch,
                                    Progress& progress, std::optional<Restart> earlier) {
  LEFORT_CHECK(paths.size() == model.segments.size());
  for (const geometry::RigidPath& path : paths) LEFORT_TRY_VOID(geometry::check_path(path));
  LEFORT_TRY(const DistanceQuerys distance_querys_B,
             detect_all(model.segments, options.contact.detection));
  LEFORT_TRY_VOID(check_reaches(paths, model.segments, distance_querys_B, options.boundary));
  const mesh::VolumeMesh& tissue = model.tissue;
  const std::vector<NodeList> attached =
      nodes_by_segment(model, nodes_with_segment(tissue, options.boundary.segment_interface));
  LEFORT_TRY_VOID(check_sets(model, paths, attached));
  const bool is_contact = options.boundary.segment_interface == SegmentInterface::kSliding;

  LEFORT_TRY(const fem::RegionMaterials materials, materials_of(options.tissue));
  LEFORT_TRY(const auto elements, fem::make_element_terms(tissue, materials));
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : elements) terms.push_back(term.get());

  FacePrediction prediction;
  std::vector<contact::ContactTerm> contacts;
  contacts.reserve(paths.size() + 1);  // The assembler points to them.
  const auto sliding = tissue.face_sets.find(sets::kStationaryContact);
  const bool slides = sliding != tissue.face_sets.end();
  if (is_contact || slides)
    prediction.contact_stiffness_mpa_per_mm =
        contact_stiffness_mpa_per_mm(options.tissue, options.contact);
  std::vector<contact::RigidObstacle> bones;  // At rest: the segments, and what tissue slides on.
  for (const auto& distance_query_B : distance_querys_B)
    bones.push_back({distance_query_B, RigidTransform::Identity()});
  if (slides) {
    LEFORT_CHECK(model.stationary_bone);
    LEFORT_TRY(auto distance_query_L,
               detect_segment(*model.stationary_bone, options.contact.detection));
    LEFORT_TRY_VOID(check_stationary_bone(*distance_query_L, options.boundary.capture_mm));
    bones.push_back({std::move(distance_query_L), RigidTransform::Identity()});
  }
  const auto add_contact = [&](std::size_t bone, const std::string& name,
                               const std::vector<mesh::Face>& faces) {
    std::vector<contact::RigidObstacle> beside = bones;
    beside.erase(beside.begin() + std::ptrdiff_t(bone));
    contacts.push_back({tissue.nodes_L,
                        faces,
                        bones[bone],
                        {.name = name,
                         .stiffness_mpa_per_mm = prediction.contact_stiffness_mpa_per_mm,
                         .capture_mm = options.boundary.capture_mm,
                         .integration = options.contact.integration,
                         .penetration_tolerance_mm = options.contact.penetration_tolerance_mm},
                        beside});
    terms.push_back(&contacts.back());
  };
  const std::size_t of_segments = is_contact ? paths.size() : 0;  // The first so many contacts.
  for (std::size_t k = 0; k < of_segments; ++k) {
    add_contact(k, "segment " + paths[k].segment, tissue.face_sets.at(sets::kContact));
    const double inside_mm = contacts[k].rest_penetration_mm();
    prediction.rest_penetration_mm = std::max(prediction.rest_penetration_mm, inside_mm);
    if (inside_mm > options.boundary.capture_mm)
      progress.note(fmt::format(
          "warning: the tissue's mesh lies up to {:.2f} mm inside the segment {} before it moves, "
          "deeper than boundary.contact_snap_mm = {:g} mm",
          inside_mm, paths[k].segment, options.boundary.capture_mm));
  }
  if (slides) add_contact(paths.size(), "still bone", sliding->second);

  const auto prescribed_at = [&](const std::vector<RigidTransform>& X_LB) {
    auto prescribed = fem::prescribe_zero(tissue.node_sets.at(sets::kFixed));
    for (std::size_t k = 0; k < X_LB.size(); ++k) {
      const auto with_bone = fem::prescribe_rigid_motion(attached[k], tissue.nodes_L, X_LB[k]);
      prescribed.insert(prescribed.end(), with_bone.begin(), with_bone.end());
    }
    return prescribed;
  };
  const auto pose_contacts = [&](const std::vector<RigidTransform>& X_LB) {
    for (std::size_t k = 0; k < of_segments; ++k) contacts[k].set_pose(X_LB[k]);
  };
  LEFORT_TRY(fem::DofMap dofs, fem::DofMap::build(tissue.node_count(),
                                                  prescribed_at(geometry::poses_at(paths, 0.0))));
  const fem::Assembler assembler(tissue.nodes_L, std::move(dofs), terms);

  std::optional<linear::LinearSolver> linear_solver(std::in_place);
  PredictionIterate seen;
  seen.attempt = 0;
  const auto solve_at = [&](double path_fraction, const VectorX& start) {
    const std::vector<RigidTransform> X_LB = geometry::poses_at(paths, path_fraction);
    pose_contacts(X_LB);
    seen.to_fraction = path_fraction;
    ++seen.attempt;
    seen.iteration = -1;
    const auto solve_from = [&](const VectorX& from) {
      fem::NewtonOptions newton = newton_options(options.solver, options.tissue);
      // As in the history: what follows an augmentation goes on without a start of its own.
      bool is_reported = watch.on_iterate && seen.iteration < 0;
      if (watch.on_iterate)
        newton.on_iterate = [&](const fem::NewtonIterate& line,
                                const fem::ResidualState& residual_state) {
          if (!std::exchange(is_reported, true)) return;
          ++seen.iteration;
          seen.line = line;
          seen.deepest_mm = residual_state.deepest_mm;
          watch.on_iterate(seen);
        };
      return fem::find_equilibrium(assembler, prescribed_at(X_LB), from, *linear_solver, newton,
                                   progress);
    };
    return contact::solve_augmented_lagrangian(contacts, tissue.nodes_L, start, solve_from);
  };
  Restart so_far;
  if (earlier) {
    so_far = *std::move(earlier);
    LEFORT_CHECK(so_far.contacts.size() == contacts.size());
    const fem::LoadState& last = so_far.stepper.last;
    pose_contacts(geometry::poses_at(paths, last.t));
    for (std::size_t k = 0; k < contacts.size(); ++k)
      contacts[k].restore(so_far.contacts[k], contact::displaced(tissue.nodes_L, last.u));
  }
  double reach_mm = std::numeric_limits<double>::infinity();
  for (const auto& distance_query_B : distance_querys_B)
    reach_mm = std::min(reach_mm, distance_query_B->max_distance_mm());
  const int parts = increments_of_step(options, paths, model.segments, reach_mm);
  const fem::LoadStepOptions increments =
      load_step_options(options.solver, 1.0 / (parts * geometry::steps_of(paths)));
  fem::LoadStepper stepper =
      earlier
          ? fem::LoadStepper::resumed(so_far.stepper, solve_at, increments)
          : fem::LoadStepper({0.0, VectorX::Zero(3 * tissue.node_count())}, solve_at, increments);

  std::size_t attempts_reported = 0;
  for (const auto& [path_fraction, is_step] : load_levels(paths, parts)) {
    if (path_fraction <= stepper.state().t) continue;  // Found by an earlier run.
    // An iterative solver's memory ends with a step, so that nothing depends on earlier ones.
    if (assembler.dofs().free_count() > linear::LinearSolverOptions{}.direct_rows)
      linear_solver.emplace();
    const Result<void> advanced = stepper.advance_to(path_fraction, progress);
    if (advanced && !is_step) continue;
    const auto& attempts = stepper.attempts();
    std::vector<fem::LoadAttempt> new_attempts(attempts.begin() + std::ptrdiff_t(attempts_reported),
                                               attempts.end());
    attempts_reported = attempts.size();
    seen.attempt = 0;
    if (!advanced) {
      if (advanced.error().code == ErrorCode::kCancelled) return tl::unexpected(advanced.error());
      if (advanced.error().code == ErrorCode::kOutOfMemory)
        return fail(ErrorCode::kOutOfMemory,
                    fmt::format("the equations of {} nodes do not fit into memory: ask for a "
                                "larger tissue.element_size_mm than {:g} mm",
                                tissue.node_count(), options.tissue.element_size_mm));
      prediction.steps = std::move(so_far.steps);
      prediction.failure = advanced.error();
      prediction.failed_attempts = std::move(new_attempts);
      return prediction;
    }

    PredictionStep result;
    result.path_fraction = path_fraction;
    for (const RigidTransform& X_LB : geometry::poses_at(paths, path_fraction))
      result.segments.push_back({.X_LB = X_LB, .contact = {}});
    result.displacement_mm = as_vectors(stepper.state().u);
    const std::vector<Vec3> at_L = contact::displaced(tissue.nodes_L, stepper.state().u);
    for (std::size_t k = 0; k < of_segments; ++k)
      result.segments[k].contact = contacts[k].summarize(at_L);
    if (slides) result.stationary_contact = contacts.back().summarize(at_L);
    result.min_J = min_volume_ratio(tissue, materials, stepper.state().u);
    const fem::NewtonIterate& last = new_attempts.back().history.back();
    result.residual_n = last.residual_n;
    if (last.residual_reference_n > 0.0)
      result.relative_residual = last.residual_n / last.residual_reference_n;
    result.attempts = std::move(new_attempts);
    if (watch.on_step) watch.on_step(result);
    progress.report(path_fraction);
    so_far.steps.push_back(std::move(result));
    if (!watch.on_restart) continue;
    so_far.stepper = stepper.checkpoint();
    so_far.contacts.clear();
    for (const contact::ContactTerm& contact : contacts)
      so_far.contacts.push_back(contact.checkpoint());
    watch.on_restart(so_far);
  }
  prediction.steps = std::move(so_far.steps);
  for (std::size_t k = 0; k < of_segments; ++k)
    prediction.touched.push_back(
        contacts[k].at_nodes(contact::displaced(tissue.nodes_L, stepper.state().u)));
  return prediction;
}

}  // namespace lefort::predict
