/// \file
/// Degrees of freedom that a deck prescribes, and their displacements at a time.
#pragma once

#include <lefort/core/error.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/solve/deck.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lefort::solve {

/// A prescribed degree of freedom and its condition.
struct PrescribedDof {
  std::int32_t node = 0;
  int component = 0;
  /// Index of the condition: Deck::displacements, then Deck::motions; -1: a node of no element.
  int by = 0;
};

/// \param mesh  with the deck's sets.
/// \param deck  its displacements and motions are used.
/// \returns each prescribed degree of freedom once, with the first condition that prescribes it,
///   and those of nodes of no element; or kPlanInvalid: a set, curve or path is invalid, or two
///   conditions prescribe one degree of freedom, unless both are in Deck::displacements and
///   prescribe the same value at all times.
[[nodiscard]] Result<std::vector<PrescribedDof>> find_prescribed_dofs(const mesh::VolumeMesh& mesh,
                                                                      const Deck& deck);

/// \param mesh             with the deck's sets.
/// \param deck             its displacements and motions are used.
/// \param prescribed_dofs  of find_prescribed_dofs().
/// \param time             0 to 1.
/// \returns the displacements [mm] at `time`, in the order of `prescribed_dofs`.
[[nodiscard]] std::vector<fem::PrescribedDisplacement> prescribed_at(
    const mesh::VolumeMesh& mesh, const Deck& deck, std::span<const PrescribedDof> prescribed_dofs,
    double time);

/// Name of a condition for messages, for example "displacements[1] (set top)".
[[nodiscard]] std::string name_of_condition(const Deck& deck, int by);

}  // namespace lefort::solve
