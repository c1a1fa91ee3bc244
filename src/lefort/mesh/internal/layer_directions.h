/// \file
/// The direction in which each covered node moves to make room for a boundary layer.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/internal/layer_constraints.h>
#include <lefort/mesh/internal/layer_surface.h>

#include <vector>

namespace lefort::mesh::internal {

/// Area-weighted inward normals, smoothed, turned towards the normal of a face to which they are
/// too oblique, and projected on the cut planes.
///
/// \param surface      the covered faces.
/// \param constraints  of the nodes of the same mesh.
/// \returns one unit vector per node; zero if the node is not covered or cannot move inwards.
[[nodiscard]] std::vector<Vec3> inward_directions(const LayerSurface& surface,
                                                  const LayerConstraints& constraints);

}  // namespace lefort::mesh::internal
