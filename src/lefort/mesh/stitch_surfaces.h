/// \file
/// Undoes a cut: stitches two closed surfaces along coincident caps.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::mesh {

/// Merges two surfaces. If a triangle of `a` and a triangle of `b` have exactly equal corners and
/// opposite orientation, as on the caps of a SurfaceCut (mesh/cut_surface.h), both are removed and
/// their corners merged. All other triangles are kept, those of `a` first.
///
/// \param a, b  closed surfaces.
/// \returns the surface of both bodies; two components if they do not touch.
[[nodiscard]] geometry::TriangleMesh stitch_surfaces(const geometry::TriangleMesh& a,
                                                     const geometry::TriangleMesh& b);

}  // namespace lefort::mesh
