/// \file
/// Repairs a surface from marching cubes so that it can be cut.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// Makes a closed manifold surface: every vertex has one fan of triangles.
///
/// - If the surface is open, vertices of equal position are merged.
/// - Triangles without area and duplicates are removed.
/// - Vertices and edges where the surface touches itself are duplicated.
/// - Triangles are oriented consistently, and outwards. If the input is already consistent, shells
///   keep their relative orientation: inner shells are cavities.
/// Self-intersections are not repaired.
///
/// \param surface  triangles of any orientation.
/// \returns the surface; kMeshInvalid if it is empty, not finite, open (the message names an edge),
///   or encloses no volume; or kMeshingFailed if memory is exhausted.
[[nodiscard]] Result<geometry::TriangleMesh> repair_surface(const geometry::TriangleMesh& surface);

}  // namespace lefort::mesh
