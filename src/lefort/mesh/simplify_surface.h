/// \file
/// Decimation of a surface.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// Collapses edges in the order of their quadric error \cite garland1997, until at most `triangles`
/// are left, or every further collapse would flip a triangle or change the topology.
///
/// \param surface    closed; it is repaired first (repair_surface.h).
/// \param triangles  max number in the result unless no further edge can be collapsed; 4 or more.
/// \param progress   receives the fraction of edges collapsed; may request a stop.
/// \returns a closed surface; kInvalidArgument for fewer than 4 triangles; the errors of
///   repair_surface(); kMeshingFailed if CGAL fails; kCancelled.
/// \note One thread; the same input gives the same bits. The result may intersect itself where two
///   parts of the surface lie close together (see count_self_intersections()).
[[nodiscard]] Result<geometry::TriangleMesh> simplify_surface(
    const geometry::TriangleMesh& surface, Index triangles, Progress& progress = Progress::none());

}  // namespace lefort::mesh
