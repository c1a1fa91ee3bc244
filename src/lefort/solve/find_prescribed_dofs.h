/// \file
/// Which components of which nodes a deck prescribes, and where they are at a time.
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

/// A component that is prescribed, and by what.
struct PrescribedDof {
  std::int32_t node = 0;
  int component = 0;
  int by = 0;  ///< Place in Deck::displacements, then in Deck::motions; -1: a node of no element.
};

/// \param mesh  with the deck's sets.
/// \returns each component once, by the first condition that prescribes it; nodes of no element are
///   held, too. Or kPlanInvalid: a set, curve or path is wrong, or two conditions move a component
///   differently.
[[nodiscard]] Result<std::vector<PrescribedDof>> find_prescribed_dofs(const mesh::VolumeMesh& mesh,
                                                                      const Deck& deck);

/// The displacements at a time, one for each of `held`, in its order.
[[nodiscard]] std::vector<fem::PrescribedDisplacement> prescribed_at(
    const mesh::VolumeMesh& mesh, const Deck& deck, std::span<const PrescribedDof> constrained,
    double time);

/// "displacements[1] (set top)" and the like, for messages.
[[nodiscard]] std::string name_of_condition(const Deck& deck, int by);

}  // namespace lefort::solve
