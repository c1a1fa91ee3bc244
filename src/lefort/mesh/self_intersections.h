/// \file
/// Where a surface crosses itself.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// How many pairs of triangles meet otherwise than in the corner or along the edge they share,
/// vertices of one position being one corner: they cross, touch, overlap, or are there twice.
///
/// Decided exactly, in the coordinates as they are. Triangles without area are passed over.
///
/// \returns the number, or what check_surface() returns.
[[nodiscard]] Result<Index> count_self_intersections(const geometry::TriangleMesh& surface);

}  // namespace lefort::mesh
