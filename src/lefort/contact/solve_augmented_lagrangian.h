/// \file
/// One load increment with contact: the outer (Uzawa) loop of the augmented Lagrangian around
/// Newton's method (\cite wriggers2006; \cite bertsekas1982, section 2.2).
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/core/types.h>
#include <lefort/fem/solve/newton.h>

#include <functional>
#include <span>
#include <vector>

namespace lefort::contact {

/// \param nodes_L  nodes in the reference configuration [mm].
/// \param u        their displacements, three per node [mm]; as in fem::Assembler.
/// \returns the current positions of the nodes [mm].
[[nodiscard]] std::vector<Vec3> displaced(std::span<const Vec3> nodes_L, const VectorX& u);

/// Max number of rounds (multiplier update, tangent planes, or both) in one increment. An update
/// leaves about the fraction k / (k + 2 k_c) of the depth, where k is the stiffness of the tissue
/// per area and k_c the penalty stiffness: a tenth if 2 k_c is nine times k.
inline constexpr int kMaxMultiplierUpdates = 30;

/// Algorithm:
///
/// 1. Solve with the accepted multipliers. If that fails, or a contact rejects the equilibrium,
///    return.
/// 2. Commit the state.
/// 3. If the P99 of the depth exceeds the tolerance of a contact, update the multipliers of all
///    contacts that have a tolerance. Activate the tangent planes that are needed. If neither was
///    needed, return.
/// 4. If three updates in a row have neither reduced the P99 below 0.99 of its minimum so far nor
///    activated a plane, roll back and return.
/// 5. Solve again from the last equilibrium. If that fails or is rejected, roll back and return the
///    last equilibrium; else continue with step 2, at most kMaxMultiplierUpdates times.
///
/// The depth is the penetration increase. The loop may end above the tolerance, for example if
/// tissue is caught at an edge of a bone or between two bones. The returned state is an equilibrium
/// all the same; ContactStatistics reports its depth.
/// \param contacts  at their poses. If an equilibrium is returned, they are in its accepted state.
/// \param nodes_L   nodes in the reference configuration [mm].
/// \param start     displacements of all nodes [mm] from which the first solve starts.
/// \param solve     finds the equilibrium from a start.
/// \returns
///   - the first outcome if it did not converge, or with kRejected if a contact rejects it;
///   - an outcome that was cancelled or ran out of memory;
///   - else the last equilibrium, with the histories of all solves, each except the first without
///     its start. After a failed solve, the last entry repeats that of the returned equilibrium.
[[nodiscard]] fem::NewtonOutcome solve_augmented_lagrangian(
    std::span<ContactTerm> contacts, std::span<const Vec3> nodes_L, const VectorX& start,
    const std::function<fem::NewtonOutcome(const VectorX& start)>& solve);

}  // namespace lefort::contact
