/// \file
/// Takes the worst tetrahedra out of a mesh by drawing one of their edges together.
#pragma once

#include <lefort/mesh/volume_mesh.h>

namespace lefort::mesh {

/// For each element whose scaled Jacobian is below `min_scaled_jacobian`, the worst first: one end
/// of one of its edges goes to the other, and the elements around the edge are gone.
///
/// Done only where the mesh stays what it was (the link condition, \cite dey1999), faces of its
/// boundary turn by no more than 25 degrees, nodes of the boundary stay on it, and the worst of the
/// elements that change is better than the worst of those before. Of all edges of an element one
/// that leaves it good enough, of those the one that turns the boundary least; else what is best.
///
/// \returns how many edges were drawn together; nodes out of use are dropped, the others keep their
///   order and place.
/// \pre One block of kTet4 with positive volumes, without sets and hinges
///   (mesh/largest_face_connected_part.h).
Index collapse_edges(VolumeMesh& mesh, double min_scaled_jacobian);

}  // namespace lefort::mesh
