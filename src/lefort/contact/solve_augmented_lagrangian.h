/// \file
/// One load step of a body and the bones it touches: equilibrium, accepted or refused, and
/// augmented until tissue lies no deeper than asked.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/core/types.h>
#include <lefort/fem/solve/newton.h>

#include <functional>
#include <span>
#include <vector>

namespace lefort::contact {

/// Where the nodes are [mm]; u as in fem::Assembler.
[[nodiscard]] std::vector<Vec3> displaced(std::span<const Vec3> nodes_L, const VectorX& u);

/// Most times that multipliers are augmented in one step. Each takes off some nine tenths of the
/// depth that is left where the penalty is ten times as stiff as the tissue (the default).
inline constexpr int kMaxMultiplierUpdates = 30;

/// Solves with the multipliers that were remembered last; while tissue lies deeper than any
/// contact's tolerance, lets multipliers bear the pressure (ContactTerm::update_multipliers) and
/// solves on.
///
/// Augmenting ends early, above the tolerance, where it takes off nothing any more or finds no
/// equilibrium: tissue is caught on an edge, where normals jump, or between bones. What was found
/// before is an equilibrium all the same and is kept; ContactStatistics tells its depth.
/// \param contacts  at their poses. What is accepted is remembered there.
/// \param solve     finds the equilibrium from a start, displacements of all nodes.
/// \returns the last equilibrium, with the histories of all solves, each but the first without its
///   start (one that failed ends with the line it went back to); kRejected if a contact refuses the
///   first; or what the first solve returned, if it did not converge; or a cancelled one.
[[nodiscard]] fem::NewtonOutcome solve_augmented_lagrangian(
    std::span<ContactTerm> contacts, std::span<const Vec3> nodes_L, const VectorX& start,
    const std::function<fem::NewtonOutcome(const VectorX& start)>& solve);

}  // namespace lefort::contact
