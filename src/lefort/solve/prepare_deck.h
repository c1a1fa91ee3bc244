/// \file
/// A deck and its mesh, checked against each other before anything is solved: names become lists of
/// nodes, faces and regions.
#pragma once

#include <lefort/core/error.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/solve/deck.h>
#include <lefort/solve/find_prescribed_dofs.h>
#include <lefort/solve/locate_probe.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lefort::solve {

/// Times that are no further apart are the same.
inline constexpr double kSameTime = 1e-9;

/// A deck whose names are found. A value.
struct PreparedDeck {
  mesh::VolumeMesh mesh;  ///< With the deck's sets.
  Deck deck;
  fem::RegionMaterials materials;
  std::map<std::int32_t, double> density_t_per_mm3;  ///< Of every region.
  std::vector<PrescribedDof> prescribed;
  std::vector<std::vector<mesh::Face>> traction_faces;  ///< Like Deck::tractions.
  std::vector<std::vector<mesh::Face>> pressure_faces;  ///< Like Deck::pressures.
  std::vector<std::vector<std::int32_t>> body_force_regions;
  std::vector<std::vector<mesh::Face>> obstacle_faces;
  std::vector<double> obstacle_stiffness_mpa_per_mm;
  std::vector<ProbePlace> probes;  ///< Like Deck::probes.
  std::vector<double> levels;      ///< Times at which an increment ends, ascending, the last 1.
  std::vector<std::string> warnings;
};

/// Finds all that the deck names, and refuses what cannot be solved.
///
/// \returns the deck, or
///   - kPlanInvalid      a name, curve or path is wrong, conditions contradict each other, or a
///                       part of the body can move as a whole; names key, set or element;
///   - kMeshInvalid, kElementInverted, kInvalidArgument  from fem::make_element_terms().
[[nodiscard]] Result<PreparedDeck> prepare_deck(mesh::VolumeMesh mesh, Deck deck);

/// The displacements at a time, one for each of PreparedDeck::prescribed, in its order.
[[nodiscard]] inline std::vector<fem::PrescribedDisplacement> prescribed_at(
    const PreparedDeck& prepared, double time) {
  return prescribed_at(prepared.mesh, prepared.deck, prepared.prescribed, time);
}

}  // namespace lefort::solve
