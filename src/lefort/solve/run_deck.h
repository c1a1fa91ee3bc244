/// \file
/// Solves a deck: from rest to time 1 in increments of adaptive size.
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

/// A converged state and the attempts that led to it.
struct Increment {
  int number = 0;  ///< From 1.
  double time = 0.0;
  VectorX u;                                ///< Displacements of all nodes [mm].
  std::vector<fem::ElementState> elements;  ///< In the order of the blocks.
  /// Strain and contact energy minus the work of loads that have a potential [mJ]. The work of a
  /// pressure on faces with a free border depends on the path and is not included.
  double energy_mj = 0.0;
  double residual_n = 0.0;
  double relative_residual = 0.0;  ///< Over the residual reference (fem/assembly/assemble.h).
  double min_J = 1.0;              ///< Of all quadrature points of elements.
  double max_displacement_mm = 0.0;
  /// Force of each condition on the body [N]: Deck::displacements, then Deck::motions. A degree of
  /// freedom that two conditions prescribe counts for the first.
  std::vector<Vec3> reactions_n;
  /// Force of each load on the body [N]: Deck::tractions, pressures, body_forces.
  std::vector<Vec3> loads_n;
  std::vector<contact::ContactStatistics> contacts;                ///< As Deck::obstacles.
  std::vector<std::vector<contact::NodalContact>> nodal_contacts;  ///< As Deck::obstacles.
  std::vector<Vec3> probes_mm;                                     ///< As Deck::probes.
  std::vector<fem::LoadAttempt> attempts;  ///< Since the previous increment.

  /// Of all attempts.
  [[nodiscard]] Index newton_iterations() const;
};

/// Result of a run.
struct DeckRun {
  std::optional<Increment> last;  ///< Last converged increment, if any.
  std::optional<Error> failure;   ///< Why time 1 was not reached; kCancelled if it was stopped.
  /// Kind used for the last increment, never kAutomatic; none if no system was solved.
  std::optional<linear::LinearSolverKind> linear_solver;
  std::vector<fem::LoadAttempt> failed_attempts;  ///< After the last converged increment.

  [[nodiscard]] bool completed() const { return !failure.has_value(); }
};

/// Callbacks of a run; each may be empty.
struct DeckWatch {
  std::function<Result<void>(const Increment&)> on_increment;  ///< An error ends the run.
  std::function<void(fem::SolvePhase)> on_phase;
  /// Called at a failure, before the diagnosis of the failure, which may take long; its error is
  /// returned by run_deck().
  std::function<Result<void>(const DeckRun&)> on_failure;
};

/// Solves a deck.
///
/// \param prepared          from prepare_deck().
/// \param distance_queries  as Deck::obstacles.
/// \param watch             callbacks.
/// \param progress          receives the time, 0 to 1; may stop the run.
/// \returns how the run ended, or
///   - an error of check_obstacles();
///   - an error of fem::make_element_terms(), fem::traction_forces(), fem::body_forces() or
///     fem::FollowerPressure::build();
///   - the error that `watch.on_increment` or `watch.on_failure` returned.
/// A run that does not reach time 1 is no error: DeckRun::failure has the reason.
[[nodiscard]] Result<DeckRun> run_deck(const PreparedDeck& prepared,
                                       const ObstacleDistanceQueries& distance_queries,
                                       const DeckWatch& watch = {},
                                       Progress& progress = Progress::none());

}  // namespace lefort::solve
