/// \file
/// Counts the self-intersections of a surface.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// Counts the pairs of triangles that cross, touch, overlap or are duplicates. Contact in a common
/// corner or along a common edge does not count; vertices of equal position are one corner.
///
/// The predicates are exact for the given coordinates. Triangles without area are ignored.
///
/// \param surface  open or closed.
/// \returns the number of pairs, or the errors of check_surface().
[[nodiscard]] Result<Index> count_self_intersections(const geometry::TriangleMesh& surface);

}  // namespace lefort::mesh
