/// \file
/// Repairs a surface from marching cubes so that it can be cut.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// Makes a closed manifold surface: every vertex has one fan of triangles.
///
/// - If the surface is open, vertices of equal position are merged and duplicates of triangles
///   removed.
/// - Triangles without area are removed.
/// - Vertices and edges where the surface touches itself are duplicated.
/// - Triangles are oriented consistently, and outwards. If the input is already consistent, shells
///   keep their relative orientation: inner shells are cavities.
/// Self-intersections are not repaired.
///
/// \param surface  triangles of any orientation.
/// \returns the surface; kMeshInvalid as check_surface(), or if the surface remains open (the
///   message names an edge), encloses no volume or cannot be repaired; or kMeshingFailed if memory
///   is exhausted.
[[nodiscard]] Result<geometry::TriangleMesh> repair_surface(const geometry::TriangleMesh& surface);

}  // namespace lefort::mesh
