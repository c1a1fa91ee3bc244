/// \file
/// Primal-dual active set strategy for weighted contact, around Newton's method (\cite hueeber2005,
/// algorithm 1; \cite popp2012, section 4).
#pragma once

#include <lefort/contact/weighted_contact_term.h>
#include <lefort/core/types.h>
#include <lefort/fem/solve/newton.h>

#include <functional>
#include <span>

namespace lefort::contact {

/// Finds the equilibrium from a start with at most `max_iterations` Newton iterations.
using SolveFrom = std::function<fem::NewtonOutcome(const VectorX& start, int max_iterations)>;

/// Algorithm. The active set consists of the nodes whose weighted gap is kept at zero by the
/// penalty, whatever its sign; the others are free. The first set consists of the nodes that have
/// contact pressure in the last equilibrium. Until the step converges and the set does not change:
///
/// 1. One Newton step with the present set. The energy of a fixed set is smooth, so that the line
///    search does not shorten steps because nodes come into contact.
/// 2. A node stays active if its pressure in the linear model of the step is positive. A free node
///    becomes active if its gap is negative.
///
/// Then, also after kMaxActiveSetSteps steps or a failed step, Newton's method with the unilateral
/// energy continues; its line search always descends. The result therefore satisfies the same
/// equations for any set. The set is no history variable. If the equations have several solutions,
/// the set can influence which one is found.
///
/// \param contacts        at their poses.
/// \param nodes_L         nodes in the reference configuration [mm].
/// \param active          active set of each contact in the last equilibrium (active_set()).
/// \param start           displacements of all nodes [mm] from which the first solve starts.
/// \param max_iterations  of the unilateral solve.
/// \param solve           one Newton step or the unilateral solve.
/// \returns the outcome with the history of all steps; at once if a step was cancelled or ran out
///   of memory.
[[nodiscard]] fem::NewtonOutcome solve_active_set(std::span<WeightedContactTerm* const> contacts,
                                                  std::span<const Vec3> nodes_L,
                                                  std::vector<ActiveSet> active,
                                                  const VectorX& start, int max_iterations,
                                                  const SolveFrom& solve);

/// Max number of steps with an active set.
inline constexpr int kMaxActiveSetSteps = 20;

}  // namespace lefort::contact
