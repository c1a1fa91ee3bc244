/// \file
/// Undoes a cut: glues two closed surfaces where their caps lie on each other.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// The surface of both bodies together.
///
/// Triangles of one that lie back to back with triangles of the other, at bitwise equal corners,
/// are dropped and their corners made one: the caps of a SurfaceCut (mesh/cut_surface.h). All else
/// stays, `a` first; so bodies that do not touch come out side by side.
[[nodiscard]] geometry::TriangleMesh stitch_surfaces(const geometry::TriangleMesh& a,
                                                     const geometry::TriangleMesh& b);

}  // namespace lefort::mesh
