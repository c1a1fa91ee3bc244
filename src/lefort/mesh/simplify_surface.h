/// \file
/// The same surface with fewer triangles.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// Collapses the edges whose loss is least by their quadric error \cite garland1997 until at most
/// `triangles` are left, or no edge can go without turning a triangle over or changing how the
/// surface hangs together.
///
/// \param surface    closed; it is repaired first (repair_surface.h).
/// \param triangles  4 or more.
/// \returns a closed surface; kInvalidArgument for fewer than 4 triangles; what repair_surface()
///   returns; kMeshingFailed if CGAL fails; kCancelled.
/// \note One thread; the same input gives the same bits. Self-intersections may arise where sheets
///   lie close together: count_self_intersections() tells.
[[nodiscard]] Result<geometry::TriangleMesh> simplify_surface(
    const geometry::TriangleMesh& surface, Index triangles, Progress& progress = Progress::none());

}  // namespace lefort::mesh
