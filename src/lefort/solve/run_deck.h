/// \file
/// The story of `lefort solve`: from rest to time 1 in increments as large as converge.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/fem/assembly/element_state.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/solve/check_obstacles.h>
#include <lefort/solve/prepare_deck.h>

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace lefort::solve {

/// A converged state and what it took to come there.
struct Increment {
  int number = 0;  ///< From 1.
  double time = 0.0;
  VectorX u;                                ///< Displacements of all nodes [mm].
  std::vector<fem::ElementState> elements;  ///< One each, through the blocks.
  /// Stored, minus the work of the loads that have a potential. What pressure on a free rim has
  /// worked depends on the way and is not counted.
  double energy_mj = 0.0;
  double residual_n = 0.0;
  double relative_residual = 0.0;  ///< To the forces that cancel (fem/assembly/assemble.h).
  double min_J = 1.0;
  double max_displacement_mm = 0.0;
  /// What each condition exerts on the body [N]: Deck::displacements, then Deck::motions. A
  /// component that two share counts for the first.
  std::vector<Vec3> reactions_n;
  /// What each load exerts on the body [N]: Deck::tractions, pressures, body_forces.
  std::vector<Vec3> loads_n;
  std::vector<contact::ContactStatistics> contacts;         ///< Like Deck::obstacles.
  std::vector<std::vector<contact::NodalContact>> touched;  ///< Likewise.
  std::vector<Vec3> probes_mm;                              ///< Like Deck::probes.
  std::vector<fem::LoadAttempt> attempts;                   ///< Since the increment before.

  /// Of all attempts.
  [[nodiscard]] Index newton_iterations() const;
};

/// How a run ended.
struct DeckRun {
  std::optional<Increment> last;  ///< The last that converged; none if not even the first did.
  std::optional<Error> failure;   ///< Why time 1 was not reached; kCancelled if it was stopped.
  /// What `automatic` took for the last that converged; none if nothing had to be solved for.
  std::optional<linear::LinearSolverKind> linear_solver;
  std::vector<fem::LoadAttempt> failed_attempts;  ///< After the last converged increment.

  [[nodiscard]] bool completed() const { return !failure.has_value(); }
};

/// Who watches a run; each may be empty.
struct DeckWatch {
  std::function<Result<void>(const Increment&)> on_increment;  ///< An error ends the run.
  std::function<void(fem::SolvePhase)> on_phase;
  /// Told a failure before it is looked into, which may take long; an error ends the run.
  std::function<Result<void>(const DeckRun&)> on_failure;
};

/// Solves a deck.
///
/// \param detectors  like Deck::obstacles.
/// \returns how it ended, or
///   - what check_obstacles() returns;
///   - what make_element_terms(), traction_forces(), body_forces() and Pressure::build() return;
///   - what `watch.on_increment` returned.
[[nodiscard]] Result<DeckRun> run_deck(const PreparedDeck& prepared,
                                       const ObstacleDistanceQueries& distance_queries,
                                       const DeckWatch& watch = {},
                                       Progress& progress = Progress::none());

}  // namespace lefort::solve
