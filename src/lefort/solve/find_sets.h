/// \file
/// The parts of a mesh that a deck names: nodes, faces, regions.
///
/// A name that is not there is kPlanInvalid, with the names that are. Nodes of no element (the
/// center of an arc in a Gmsh file) belong to no set.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/solve/deck.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lefort::solve {

/// \returns for each node whether an element has it. \pre elements name nodes that exist.
[[nodiscard]] std::vector<char> nodes_of_elements(const mesh::VolumeMesh& mesh);

/// Adds the deck's sets to the node sets of the mesh, which they may build on but not replace.
///
/// \returns kPlanInvalid, naming the set: its name is taken, or it would have no node.
[[nodiscard]] Result<mesh::VolumeMesh> add_sets(mesh::VolumeMesh mesh,
                                                std::span<const SetChoice> sets);

/// The nodes of a node set, or of a face set if there is no node set of that name; ascending.
[[nodiscard]] Result<std::vector<std::int32_t>> find_nodes(const mesh::VolumeMesh& mesh,
                                                           const std::string& set);

/// The faces of a face set; if there is none of that name, the boundary faces all of whose nodes
/// are in the node set of that name.
[[nodiscard]] Result<std::vector<mesh::Face>> find_faces(const mesh::VolumeMesh& mesh,
                                                         const std::string& set);

/// The numbers of the regions that occur, ascending.
[[nodiscard]] std::vector<std::int32_t> regions_of(const mesh::VolumeMesh& mesh);

/// The number of a region told by name or number.
[[nodiscard]] Result<std::int32_t> find_region(const mesh::VolumeMesh& mesh,
                                               const std::string& region);

}  // namespace lefort::solve
