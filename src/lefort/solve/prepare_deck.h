/// \file
/// Checks a deck and its mesh before the solve: names become lists of nodes, faces and regions.
#pragma once

#include <lefort/contact/penalty.h>
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

/// Times (0 to 1) that differ by at most this count as equal.
inline constexpr double kSameTime = 1e-9;

/// A deck and its mesh; names are replaced by nodes, faces and regions.
struct PreparedDeck {
  mesh::VolumeMesh mesh;  ///< With the deck's sets.
  Deck deck;
  fem::RegionMaterials materials;
  std::map<std::int32_t, double> density_t_per_mm3;  ///< Of every region.
  std::vector<PrescribedDof> prescribed;
  std::vector<std::vector<mesh::Face>> traction_faces;        ///< As Deck::tractions.
  std::vector<std::vector<mesh::Face>> pressure_faces;        ///< As Deck::pressures.
  std::vector<std::vector<std::int32_t>> body_force_regions;  ///< As Deck::body_forces.
  std::vector<std::vector<mesh::Face>> obstacle_faces;        ///< As Deck::obstacles.
  std::vector<double> obstacle_stiffness_mpa_per_mm;          ///< As Deck::obstacles.
  std::vector<contact::PressureLaw> obstacle_laws;            ///< Likewise; of quadrature.
  std::vector<ProbePlace> probes;                             ///< As Deck::probes.
  std::vector<double> levels;  ///< Times at which an increment ends, ascending, the last 1.
  std::vector<std::string> warnings;
};

/// Finds all names of the deck and rejects problems that cannot be solved.
///
/// \param mesh  of the body.
/// \param deck  the problem.
/// \returns the deck, or
///   - kPlanInvalid      a name, curve or path is invalid; conditions contradict each other; a
///     region has no material, or no density for a body force; a face of a pressure or an obstacle
///     lies between two elements; a probe lies outside the body; or a part of the body that no
///     obstacle may touch can move as a rigid body. The message names key, set or element;
///   - kMeshInvalid      a node number or list length is wrong, there is no element, or an error of
///     check_joints();
///   - kInvalidArgument  Deck::steps or Deck::newton is invalid;
///   - kMeshInvalid, kElementInverted, kInvalidArgument  from fem::make_element_terms().
[[nodiscard]] Result<PreparedDeck> prepare_deck(mesh::VolumeMesh mesh, Deck deck);

/// Displacements at a time, in the order of PreparedDeck::prescribed.
[[nodiscard]] inline std::vector<fem::PrescribedDisplacement> prescribed_at(
    const PreparedDeck& prepared, double time) {
  return prescribed_at(prepared.mesh, prepared.deck, prepared.prescribed, time);
}

}  // namespace lefort::solve
