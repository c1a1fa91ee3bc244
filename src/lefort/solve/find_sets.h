/// \file
/// Finds nodes, faces and regions of a mesh by the names in a deck.
/// An unknown name is kPlanInvalid, and the message lists the known names; an empty set is
/// kPlanInvalid, too. Nodes of no element (the center of an arc in a Gmsh file) are not found.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/solve/deck.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lefort::solve {

/// \returns for each node whether it belongs to an element. \pre nodes of elements exist.
[[nodiscard]] std::vector<char> nodes_of_elements(const mesh::VolumeMesh& mesh);

/// Adds the deck's sets to the node sets of the mesh.
///
/// \returns the mesh; or kPlanInvalid with the name of the set, if the mesh has a set of this name,
///   the set would be empty, or its region or one of its node numbers does not exist.
[[nodiscard]] Result<mesh::VolumeMesh> add_sets(mesh::VolumeMesh mesh,
                                                std::span<const SetChoice> sets);

/// Nodes of a node set, or of a face set if there is no node set of that name; ascending.
[[nodiscard]] Result<std::vector<std::int32_t>> find_nodes(const mesh::VolumeMesh& mesh,
                                                           const std::string& set);

/// Faces of a face set; if there is none of that name or it is empty, the boundary faces whose
/// nodes all belong to the node set of that name.
[[nodiscard]] Result<std::vector<mesh::Face>> find_faces(const mesh::VolumeMesh& mesh,
                                                         const std::string& set);

/// Numbers of the regions that occur, ascending.
[[nodiscard]] std::vector<std::int32_t> regions_of(const mesh::VolumeMesh& mesh);

/// Number of a region given by name or number.
[[nodiscard]] Result<std::int32_t> find_region(const mesh::VolumeMesh& mesh,
                                               const std::string& region);

}  // namespace lefort::solve
