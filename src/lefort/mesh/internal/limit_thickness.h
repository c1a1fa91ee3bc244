/// \file
/// The thickness that a boundary layer may have at each covered node.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/internal/layer_constraints.h>
#include <lefort/mesh/internal/layer_surface.h>

#include <span>
#include <vector>

namespace lefort::mesh::internal {

/// Limits the thickness to a third of the distance through the body, and its change between two
/// nodes of a face to half of their distance.
///
/// \param surface       the covered faces.
/// \param boundary      all boundary triangles of the mesh.
/// \param constraints   of the nodes of the same mesh.
/// \param inwards       the direction of each node, a unit vector or zero.
/// \param thickness_mm  the thickness without limits, > 0.
/// \returns the thickness of each node [mm], 0 for nodes that do not move.
[[nodiscard]] std::vector<double> limited_thickness_mm(const LayerSurface& surface,
                                                       const std::vector<Face3>& boundary,
                                                       const LayerConstraints& constraints,
                                                       std::span<const Vec3> inwards,
                                                       double thickness_mm);

}  // namespace lefort::mesh::internal
