#include <lefort/contact/contact_surface.h>
#include <lefort/contact/solve_active_set.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/solve/find_weakest_mode.h>
#include <lefort/solve/problem.h>
#include <lefort/solve/run_deck.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

namespace lefort::solve {
namespace {

/// Whether Newton found a tangent that was not positive definite.
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

/// Describes the element with the smallest J.
std::string describe_min_J(const PreparedDeck& prepared, const VectorX& u) {
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

/// The weakest mode, unless it needs a factorization that the solver itself avoids.
std::optional<WeakestMode> weakest_mode(const Problem& problem, const VectorX& u,
                                        Progress& progress) {
  const linear::LinearSolverOptions& solver = problem.prepared().deck.linear_solver;
  const bool is_small = problem.assembler().dofs().free_count() <= solver.direct_rows;
  if (!is_small && solver.kind != linear::LinearSolverKind::kDirect) return std::nullopt;
  return find_weakest_mode(problem.assembler(), u, progress);
}

std::string describe_place(const mesh::VolumeMesh& mesh, const WeakestMode& mode) {
  const Vec3& at_L = mesh.nodes_L[std::size_t(mode.node)];
  return fmt::format("at node {} of element {} at ({:.3f}, {:.3f}, {:.3f}) mm", mode.node,
                     element_at(mesh, mode.node), at_L.x(), at_L.y(), at_L.z());
}

/// Likely cause of a failure, from the last state and Newton's history.
std::string diagnosis(const Problem& problem, const fem::LoadState& last,
                      const std::vector<fem::LoadAttempt>& attempts, Progress& progress) {
  const auto forces = problem.assembler().forces(last.u);
  const bool has_followers = forces && forces->follower_n.size() > 0;
  const auto mode = weakest_mode(problem, last.u, progress);
  const mesh::VolumeMesh& mesh = problem.prepared().mesh;
  if (mode && !mode->resists && last.t == 0.0)
    return fmt::format(
        "at rest the tangent is singular: a part of the body is not fixed, or is connected "
        "only by a node or an edge; its motion is largest {}",
        describe_place(mesh, *mode));
  // With follower pressures only the symmetric part of the tangent is factorized; its eigenvalues
  // do not decide stability.
  if (has_followers)
    return fmt::format(
        "a pressure on faces with a free boundary may have reached a state in which the body is "
        "unstable; smallest J: {}",
        describe_min_J(problem.prepared(), last.u));
  if (mode && !mode->resists)
    return fmt::format(
        "the tangent is not positive definite at load level {:.6g}: the load may lie beyond a "
        "limit point, where the body buckles or collapses; the weakest mode is largest {}",
        last.t, describe_place(mesh, *mode));
  if (mode && met_instability(attempts))
    return fmt::format(
        "at load level {:.6g} the tangent is positive definite (weakest mode: {}), but beyond it "
        "Newton found tangents that are not positive definite: the load may lie beyond a limit "
        "point, where the body buckles or collapses",
        last.t, describe_place(mesh, *mode));
  return fmt::format(
      "smallest J: {}; a smaller steps.min_increment or more newton.max_iterations may help",
      describe_min_J(problem.prepared(), last.u));
}

/// Adds the likely cause to Newton's message.
Error explained(const Error& error, const Problem& problem, const fem::LoadState& last,
                const std::vector<fem::LoadAttempt>& attempts, Progress& progress) {
  if (error.code == ErrorCode::kOutOfMemory)
    return {error.code, fmt::format("{}: the equations of {} nodes do not fit into memory; "
                                    "linear_solver multigrid needs the "
                                    "least",
                                    error.message, problem.prepared().mesh.node_count())};
  if (error.code != ErrorCode::kNotConverged) return error;
  return {error.code,
          fmt::format("{}; {}", error.message, diagnosis(problem, last, attempts, progress))};
}

fem::NewtonOptions newton_options(const Problem& problem, const DeckWatch& watch) {
  constexpr double kSafety = 4.0;  // The round-off is an estimate.
  fem::NewtonOptions options = problem.prepared().deck.newton;
  const VectorX at_rest = VectorX::Zero(3 * problem.prepared().mesh.node_count());
  if (problem.assembler().forces(at_rest))
    options.round_off_n = kSafety * problem.assembler().force_round_off_n(at_rest);
  options.on_phase = watch.on_phase;
  if (problem.has_weighted_contact())
    options.max_step_length = [&problem](const VectorX& u, const VectorX& du) {
      return problem.max_step_length(u, du);
    };
  return options;
}

/// Whether all loads are zero and all prescribed nodes are at rest; obstacles are not considered.
bool is_at_rest(const PreparedDeck& prepared, double time) {
  const Deck& deck = prepared.deck;
  const auto is_loaded = [&](const auto& load) { return factor_at(load.curve, time) != 0.0; };
  const auto prescribed = prescribed_at(prepared, time);
  return std::none_of(deck.tractions.begin(), deck.tractions.end(), is_loaded) &&
         std::none_of(deck.pressures.begin(), deck.pressures.end(), is_loaded) &&
         std::none_of(deck.body_forces.begin(), deck.body_forces.end(), is_loaded) &&
         std::all_of(prescribed.begin(), prescribed.end(),
                     [](const auto& node) { return node.displacement_mm == 0.0; });
}

/// A run in progress: the problem, its solver and what was found so far.
class DeckRunner {
 public:
  /// Arguments must outlive the object.
  DeckRunner(Problem& problem, const DeckWatch& watch, Progress& progress)
      : problem_(problem),
        prepared_(problem.prepared()),
        watch_(watch),
        progress_(progress),
        newton_(newton_options(problem, watch)),
        linear_solver_(prepared_.deck.linear_solver),
        stepper_(
            {0.0, VectorX::Zero(3 * prepared_.mesh.node_count())},
            [this](double time, const VectorX& start) { return solve_at(time, start); },
            prepared_.deck.steps) {}
  DeckRunner(const DeckRunner&) = delete;
  DeckRunner& operator=(const DeckRunner&) = delete;

  /// From time 0 to 1. \returns as run_deck().
  [[nodiscard]] Result<DeckRun> run();

 private:
  [[nodiscard]] fem::NewtonOutcome solve_at(double time, const VectorX& start);
  [[nodiscard]] fem::NewtonOutcome solve_from(double time, const VectorX& start,
                                              int max_iterations);
  [[nodiscard]] std::vector<fem::LoadAttempt> take_new_attempts();
  [[nodiscard]] Result<void> record(const fem::LoadState& state);
  [[nodiscard]] Result<void> record_failure(const Error& error);

  Problem& problem_;
  const PreparedDeck& prepared_;
  const DeckWatch& watch_;
  Progress& progress_;
  fem::NewtonOptions newton_;
  linear::LinearSolver linear_solver_;
  fem::LoadStepper stepper_;
  std::size_t recorded_attempts_ = 0;
  std::optional<Error> watch_error_;  ///< Returned by the watch, not by the solver.
  DeckRun run_;
};

Result<DeckRun> DeckRunner::run() {
  for (const double level : prepared_.levels) {
    const Result<void> advanced = stepper_.advance_to(
        level, progress_, [this](const fem::LoadState& state) { return record(state); });
    if (advanced) continue;
    if (watch_error_) return tl::unexpected(*watch_error_);
    LEFORT_TRY_VOID(record_failure(advanced.error()));
    break;
  }
  return std::move(run_);
}

fem::NewtonOutcome DeckRunner::solve_at(double time, const VectorX& start) {
  problem_.set_time(time);
  newton_.may_accept_start_by_round_off = is_at_rest(prepared_, time);
  const int max_iterations = prepared_.deck.newton.max_iterations;
  fem::NewtonOutcome outcome;
  if (!problem_.has_weighted_contact())
    outcome = solve_from(time, start, max_iterations);
  else if (auto passed = problem_.passage_at_start(stepper_.state(), start))
    outcome = *std::move(passed);
  else
    outcome = contact::solve_active_set(
        problem_.weighted_contacts(), prepared_.mesh.nodes_L,
        problem_.active_sets(stepper_.state(), time), start, max_iterations,
        [&](const VectorX& from, int iterations) { return solve_from(time, from, iterations); });
  if (outcome.converged()) problem_.note_clearances(outcome.x);
  return outcome;
}

fem::NewtonOutcome DeckRunner::solve_from(double time, const VectorX& start, int max_iterations) {
  newton_.max_iterations = max_iterations;
  fem::NewtonOutcome outcome =
      fem::find_equilibrium(problem_.assembler(), prescribed_at(prepared_, time), start,
                            linear_solver_, newton_, progress_);
  if (outcome.converged()) problem_.reject_passages(stepper_.state(), outcome);
  return outcome;
}

/// Attempts since the last increment.
std::vector<fem::LoadAttempt> DeckRunner::take_new_attempts() {
  const std::vector<fem::LoadAttempt>& all = stepper_.attempts();
  std::vector<fem::LoadAttempt> attempts(all.begin() + std::ptrdiff_t(recorded_attempts_),
                                         all.end());
  recorded_attempts_ = all.size();
  return attempts;
}

/// Makes a converged state the last increment.
Result<void> DeckRunner::record(const fem::LoadState& state) {
  Increment increment = problem_.describe(state);
  increment.number = run_.last ? run_.last->number + 1 : 1;
  increment.attempts = take_new_attempts();
  const fem::NewtonIterate& end = increment.attempts.back().history.back();
  increment.residual_n = end.residual_n;
  if (end.residual_reference_n > 0.0)
    increment.relative_residual = end.residual_n / end.residual_reference_n;
  run_.last = std::move(increment);
  if (linear_solver_.statistics().factorizations > 0) run_.linear_solver = linear_solver_.kind();
  progress_.report(state.t);
  if (!watch_.on_increment) return {};
  Result<void> reported = watch_.on_increment(*run_.last);
  if (!reported) watch_error_ = reported.error();
  return reported;
}

/// Ends the run at the last increment and adds a diagnosis.
Result<void> DeckRunner::record_failure(const Error& error) {
  run_.failed_attempts = take_new_attempts();
  problem_.set_time(stepper_.state().t);
  run_.failure = error;
  if (watch_.on_failure) LEFORT_TRY_VOID(watch_.on_failure(run_));
  run_.failure = explained(error, problem_, stepper_.state(), run_.failed_attempts, progress_);
  return {};
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
  return DeckRunner(*problem, watch, progress).run();
}

}  // namespace lefort::solve
