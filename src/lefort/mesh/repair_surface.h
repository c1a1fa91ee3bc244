/// \file
/// Makes a surface from marching cubes fit for cutting.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// A closed surface whose every vertex has one fan of triangles.
///
/// Vertices of equal position are merged if it is not closed without that; triangles without area
/// and doubled ones dropped; vertices and edges where the surface touches itself doubled; triangles
/// oriented alike; the whole turned if it is inside out. Where the input is oriented already its
/// shells keep their orientation: inner shells are cavities. Self-intersections stay.
///
/// \returns the surface; kMeshInvalid if it is empty, not finite, open (the message names an edge),
///   or encloses nothing; or kMeshingFailed if the memory is too small.
[[nodiscard]] Result<geometry::TriangleMesh> repair_surface(const geometry::TriangleMesh& surface);

}  // namespace lefort::mesh
