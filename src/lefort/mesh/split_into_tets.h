/// \file
/// Splits all elements of a linear mesh into tetrahedra.
#pragma once

#include <lefort/mesh/volume_mesh.h>

namespace lefort::mesh {

/// Splits wedges, pyramids and hexahedra into tetrahedra: an element is divided into the pyramids
/// over its faces with their common apex at one of its nodes. That node, and one end of the
/// diagonal of a quadrilateral, is the first by position (x, then y, then z). The two elements at a
/// quadrilateral therefore have the same diagonal (\cite dompierre1999), and so have the two sides
/// of a slit. No node is added.
///
/// \param mesh  linear elements.
/// \returns one block of tet4; parts of an element keep its region, in the order of the elements.
///   Quadrilaterals of the face sets are split by the same diagonals.
/// \pre nodes of an element have different positions.
[[nodiscard]] VolumeMesh split_into_tets(VolumeMesh mesh);

}  // namespace lefort::mesh
