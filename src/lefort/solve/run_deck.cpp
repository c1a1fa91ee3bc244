#include <lefort/contact/solve_augmented_lagrangian.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/solve/continuous_contact_check.h>
#include <lefort/solve/deck_loads.h>
#include <lefort/solve/find_weakest_mode.h>
#include <lefort/solve/run_deck.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace lefort::solve {
namespace {

using ElementTerms = std::vector<std::unique_ptr<const fem::ForceTerm>>;

/// The terms of a deck, and the pose and size of each at a time.
class Problem {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Problem>> build(
      const PreparedDeck& prepared, const ObstacleDistanceQueries& distance_queries) {
    LEFORT_TRY_VOID(check_obstacles(prepared, distance_queries));
    LEFORT_TRY(ElementTerms elements, fem::make_element_terms(prepared.mesh, prepared.materials));
    LEFORT_TRY(DeckLoads loads, DeckLoads::build(prepared));
    LEFORT_TRY(fem::DofMap dofs,
               fem::DofMap::build(prepared.mesh.node_count(), prescribed_at(prepared, 0.0)));
    return std::unique_ptr<Problem>(new Problem(prepared, distance_queries, std::move(elements),
                                                std::move(loads), std::move(dofs)));
  }

  void set_time(double time) {
    loads_.set_time(time);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      obstacles_[i].X_LB = geometry::pose_at(prepared_.deck.obstacles[i].path, time);
      contacts_[i].set_pose(obstacles_[i].X_LB);
    }
  }

  /// An equilibrium is refused if an obstacle passed through faces on the way to it.
  void refuse_passages(fem::NewtonOutcome& outcome) const {
    const std::vector<Vec3> x_L = contact::displaced(prepared_.mesh.nodes_L, outcome.x);
    for (std::size_t i = 0; i < swept_.size() && outcome.converged(); ++i)
      if (auto why = swept_[i].rejection_reason(obstacles_[i], x_L)) {
        outcome.stop = fem::NewtonStop::kRejected;
        outcome.reason = *std::move(why);
      }
  }

  /// The next ways begin at an accepted equilibrium.
  void commit(const VectorX& u) {
    const std::vector<Vec3> x_L = contact::displaced(prepared_.mesh.nodes_L, u);
    for (std::size_t i = 0; i < swept_.size(); ++i) swept_[i].commit(obstacles_[i], x_L);
  }

  /// What there is to tell of a converged state.
  [[nodiscard]] Increment describe(const fem::LoadState& state) const;

  [[nodiscard]] std::span<contact::ContactTerm> contacts() { return contacts_; }
  [[nodiscard]] const fem::Assembler& assembler() const { return assembler_; }
  [[nodiscard]] const PreparedDeck& prepared() const { return prepared_; }

 private:
  Problem(const PreparedDeck& prepared, const ObstacleDistanceQueries& distance_queries,
          ElementTerms elements, DeckLoads loads, fem::DofMap dofs)
      : prepared_(prepared),
        elements_(std::move(elements)),
        loads_(std::move(loads)),
        obstacles_(make_obstacles(distance_queries)),
        contacts_(make_contacts(prepared, distance_queries)),
        swept_(make_swept(prepared, obstacles_)),
        assembler_(prepared.mesh.nodes_L, std::move(dofs), all_terms()) {}

  static std::vector<contact::RigidObstacle> make_obstacles(
      const ObstacleDistanceQueries& distance_queries) {
    std::vector<contact::RigidObstacle> obstacles;
    for (const auto& distance_query : distance_queries)
      obstacles.push_back({.distance_query_B = distance_query});
    return obstacles;
  }

  static std::vector<contact::ContactTerm> make_contacts(
      const PreparedDeck& prepared, const ObstacleDistanceQueries& distance_queries) {
    std::vector<contact::ContactTerm> contacts;
    contacts.reserve(distance_queries.size());  // The assembler points to them.
    for (std::size_t i = 0; i < distance_queries.size(); ++i)
      contacts.push_back(make_contact(prepared, i, distance_queries[i]));
    return contacts;
  }

  static std::vector<ContinuousContactCheck> make_swept(
      const PreparedDeck& prepared, const std::vector<contact::RigidObstacle>& obstacles) {
    std::vector<ContinuousContactCheck> swept;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      swept.emplace_back(prepared.mesh.nodes_L, prepared.obstacle_faces[i],
                         "obstacle " + prepared.deck.obstacles[i].name);
      swept.back().commit(obstacles[i], prepared.mesh.nodes_L);
    }
    return swept;
  }

  [[nodiscard]] std::vector<const fem::ForceTerm*> all_terms() const {
    std::vector<const fem::ForceTerm*> terms;
    for (const auto& term : elements_) terms.push_back(term.get());
    for (const fem::ForceTerm* load : loads_.terms()) terms.push_back(load);
    for (const contact::ContactTerm& contact : contacts_) terms.push_back(&contact);
    return terms;
  }

  const PreparedDeck& prepared_;
  ElementTerms elements_;
  DeckLoads loads_;
  std::vector<contact::RigidObstacle> obstacles_;  ///< As they lie.
  std::vector<contact::ContactTerm> contacts_;
  std::vector<ContinuousContactCheck> swept_;
  fem::Assembler assembler_;
};

Increment Problem::describe(const fem::LoadState& state) const {
  const Deck& deck = prepared_.deck;
  const std::vector<Vec3> x_L = contact::displaced(prepared_.mesh.nodes_L, state.u);
  Increment reported;
  reported.time = state.t;
  reported.u = state.u;
  reported.elements = fem::element_states(prepared_.mesh, prepared_.materials, state.u);
  reported.min_J = std::numeric_limits<double>::infinity();
  for (const fem::ElementState& element : reported.elements)
    reported.min_J = std::min(reported.min_J, element.min_volume_ratio);
  for (Index n = 0; n < prepared_.mesh.node_count(); ++n)
    reported.max_displacement_mm =
        std::max(reported.max_displacement_mm, state.u.segment<3>(3 * n).norm());

  const auto forces = assembler_.forces(state.u);
  LEFORT_CHECK(forces.has_value());
  reported.energy_mj = forces->energy_mj;
  reported.reactions_n.assign(deck.displacements.size() + deck.motions.size(), Vec3::Zero());
  for (const PrescribedDof& prescribed : prepared_.prescribed)
    if (prescribed.by >= 0)
      reported.reactions_n[std::size_t(prescribed.by)][prescribed.component] +=
          forces->residual_n[3 * Index(prescribed.node) + prescribed.component];
  reported.loads_n = loads_.totals_n(x_L);
  for (const contact::ContactTerm& contact : contacts_) {
    reported.contacts.push_back(contact.summarize(x_L));
    reported.touched.push_back(contact.at_nodes(x_L));
  }
  for (const ProbePlace& probe : prepared_.probes)
    reported.probes_mm.push_back(displacement_of(probe, state.u));
  return reported;
}

/// Whether Newton met a tangent that was not positive definite.
bool met_instability(const std::vector<fem::LoadAttempt>& attempts) {
  if (attempts.empty()) return false;
  const std::vector<fem::NewtonIterate>& history = attempts.back().history;
  return std::any_of(history.begin(), history.end(), [](const fem::NewtonIterate& iterate) {
    return iterate.tangent_blend > 0.0 || iterate.diagonal_shift > 0.0;
  });
}

/// The first element with a node, counted through the blocks.
Index element_at(const mesh::VolumeMesh& mesh, std::int32_t node) {
  Index number = 0;
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e, ++number) {
      const std::int32_t* const nodes = block.element(e);
      const std::int32_t* const end = nodes + mesh::node_count(block.shape);
      if (std::find(nodes, end, node) != end) return number;
    }
  return -1;
}

/// The element with the least J, in words.
std::string max_compressed(const PreparedDeck& prepared, const VectorX& u) {
  const mesh::VolumeMesh& mesh = prepared.mesh;
  const auto states = fem::element_states(mesh, prepared.materials, u);
  const auto minimum = std::min_element(states.begin(), states.end(),
                                        [](const fem::ElementState& a, const fem::ElementState& b) {
                                          return a.min_volume_ratio < b.min_volume_ratio;
                                        });
  Index left = minimum - states.begin();
  for (const mesh::ElementBlock& block : mesh.blocks) {
    if (left >= block.element_count()) {
      left -= block.element_count();
      continue;
    }
    Vec3 at_L = Vec3::Zero();
    const int count = mesh::node_count(block.shape);
    for (int a = 0; a < count; ++a)
      at_L += mesh.nodes_L[std::size_t(block.element(left)[a])] / double(count);
    return fmt::format("element {} at ({:.3f}, {:.3f}, {:.3f}) mm, J = {:.3g}",
                       minimum - states.begin(), at_L.x(), at_L.y(), at_L.z(),
                       minimum->min_volume_ratio);
  }
  return "no element";
}

/// What resists least, unless looking for it takes a factor that the solver itself would avoid.
std::optional<WeakestMode> weakest_mode(const Problem& problem, const VectorX& u,
                                        Progress& progress) {
  const linear::LinearSolverOptions& solver = problem.prepared().deck.linear_solver;
  const bool is_small = problem.assembler().dofs().free_count() <= solver.direct_rows;
  if (!is_small && solver.kind != linear::LinearSolverKind::kDirect) return std::nullopt;
  return find_weakest_mode(problem.assembler(), u, progress);
}

std::string place_of(const mesh::VolumeMesh& mesh, const WeakestMode& spot) {
  const Vec3& at_L = mesh.nodes_L[std::size_t(spot.node)];
  return fmt::format("at node {} of element {} at ({:.3f}, {:.3f}, {:.3f}) mm", spot.node,
                     element_at(mesh, spot.node), at_L.x(), at_L.y(), at_L.z());
}

/// What may be behind a failure, as far as the last state and Newton's history tell.
std::string diagnosis(const Problem& problem, const fem::LoadState& last,
                      const std::vector<fem::LoadAttempt>& attempts, Progress& progress) {
  const auto forces = problem.assembler().forces(last.u);
  const bool has_followers = forces && forces->follower_n.size() > 0;
  const auto spot = weakest_mode(problem, last.u, progress);
  const mesh::VolumeMesh& mesh = problem.prepared().mesh;
  if (spot && !spot->resists && last.t == 0.0)
    return fmt::format(
        "at rest the tangent is singular: something is not held, or hangs by a node or an edge "
        "alone, and gives way, most {}",
        place_of(mesh, *spot));
  // With followers only the symmetric part of the tangent is known, whose sign proves nothing.
  if (has_followers)
    return fmt::format(
        "a pressure on faces with a free rim may have met a state in which the body gives way; "
        "most compressed is {}",
        max_compressed(problem.prepared(), last.u));
  if (spot && !spot->resists)
    return fmt::format(
        "the tangent is not positive definite any more at load level {:.6g}: the load may lie "
        "beyond a limit point, where the body buckles or collapses; it gives way, most {}",
        last.t, place_of(mesh, *spot));
  if (spot && met_instability(attempts))
    return fmt::format(
        "at load level {:.6g} the body still resists, least {}, but beyond Newton met tangents "
        "that are not positive definite: the load may lie beyond a limit point, where the body "
        "buckles or collapses",
        last.t, place_of(mesh, *spot));
  return fmt::format(
      "most compressed is {}; a smaller steps.min_increment or more newton.max_iterations may help",
      max_compressed(problem.prepared(), last.u));
}

/// Adds to Newton's sentence what may be behind it.
Error explained(const Error& error, const Problem& problem, const fem::LoadState& last,
                const std::vector<fem::LoadAttempt>& attempts, Progress& progress) {
  if (error.code == ErrorCode::kOutOfMemory)
    return {error.code,
            fmt::format("{}: the equations of {} nodes do not fit into memory; linear_solver "
                        "multigrid takes least",
                        error.message, problem.prepared().mesh.node_count())};
  if (error.code != ErrorCode::kNotConverged) return error;
  return {error.code,
          fmt::format("{}; {}", error.message, diagnosis(problem, last, attempts, progress))};
}

fem::NewtonOptions newton_options(const Problem& problem, const DeckWatch& watch) {
  constexpr double kSlack = 4.0;  // Of an estimate.
  fem::NewtonOptions options = problem.prepared().deck.newton;
  const VectorX at_rest = VectorX::Zero(3 * problem.prepared().mesh.node_count());
  if (problem.assembler().forces(at_rest))
    options.round_off_n = kSlack * problem.assembler().force_round_off_n(at_rest);
  options.on_phase = watch.on_phase;
  return options;
}

/// Whether nothing pushes the body and its held nodes are where they rest; obstacles apart.
bool is_at_rest(const PreparedDeck& prepared, double time) {
  const Deck& deck = prepared.deck;
  const auto pushes = [&](const auto& load) { return factor_at(load.curve, time) != 0.0; };
  const auto prescribed = prescribed_at(prepared, time);
  return std::none_of(deck.tractions.begin(), deck.tractions.end(), pushes) &&
         std::none_of(deck.pressures.begin(), deck.pressures.end(), pushes) &&
         std::none_of(deck.body_forces.begin(), deck.body_forces.end(), pushes) &&
         std::all_of(prescribed.begin(), prescribed.end(),
                     [](const auto& node) { return node.displacement_mm == 0.0; });
}

}  // namespace

Index Increment::newton_iterations() const {
  Index count = 0;
  for (const fem::LoadAttempt& attempt : attempts)
    count += std::max<Index>(Index(attempt.history.size()) - 1, 0);
  return count;
}

Result<DeckRun> run_deck(const PreparedDeck& prepared,
                         const ObstacleDistanceQueries& distance_queries, const DeckWatch& watch,
                         Progress& progress) {
  LEFORT_TRY(const std::unique_ptr<Problem> problem, Problem::build(prepared, distance_queries));
  fem::NewtonOptions newton = newton_options(*problem, watch);
  linear::LinearSolver linear_solver(prepared.deck.linear_solver);
  const auto solve_at = [&](double time, const VectorX& start) {
    problem->set_time(time);
    newton.may_start_at_rest = is_at_rest(prepared, time);
    const auto solve_from = [&](const VectorX& from) {
      fem::NewtonOutcome outcome =
          fem::find_equilibrium(problem->assembler(), prescribed_at(prepared, time), from,
                                linear_solver, newton, progress);
      if (outcome.converged()) problem->refuse_passages(outcome);
      return outcome;
    };
    fem::NewtonOutcome settled = contact::solve_augmented_lagrangian(
        problem->contacts(), prepared.mesh.nodes_L, start, solve_from);
    if (settled.converged()) problem->commit(settled.x);
    return settled;
  };
  fem::LoadStepper stepper({0.0, VectorX::Zero(3 * prepared.mesh.node_count())}, solve_at,
                           prepared.deck.steps);

  DeckRun run;
  std::size_t attempts_reported = 0;
  std::optional<Error> not_reported;  ///< The watch's own, to be told apart from the solver's.
  const auto new_attempts = [&] {
    const auto& all = stepper.attempts();
    std::vector<fem::LoadAttempt> attempts(all.begin() + std::ptrdiff_t(attempts_reported),
                                           all.end());
    attempts_reported = all.size();
    return attempts;
  };
  const auto on_state = [&](const fem::LoadState& state) -> Result<void> {
    Increment increment = problem->describe(state);
    increment.number = run.last ? run.last->number + 1 : 1;
    increment.attempts = new_attempts();
    const fem::NewtonIterate& end = increment.attempts.back().history.back();
    increment.residual_n = end.residual_n;
    if (end.residual_reference_n > 0.0)
      increment.relative_residual = end.residual_n / end.residual_reference_n;
    run.last = std::move(increment);
    if (linear_solver.statistics().factorizations > 0) run.linear_solver = linear_solver.kind();
    progress.report(state.t);
    if (!watch.on_increment) return {};
    Result<void> reported = watch.on_increment(*run.last);
    if (!reported) not_reported = reported.error();
    return reported;
  };
  for (const double level : prepared.levels) {
    const Result<void> advanced = stepper.advance_to(level, progress, on_state);
    if (advanced) continue;
    if (not_reported) return tl::unexpected(*not_reported);
    run.failed_attempts = new_attempts();
    problem->set_time(stepper.state().t);
    run.failure = advanced.error();
    if (watch.on_failure) LEFORT_TRY_VOID(watch.on_failure(run));
    run.failure =
        explained(advanced.error(), *problem, stepper.state(), run.failed_attempts, progress);
    break;
  }
  return run;
}

}  // namespace lefort::solve
