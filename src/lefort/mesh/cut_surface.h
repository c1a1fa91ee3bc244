/// \file
/// Splits a closed surface by a convex set of half-spaces into two closed surfaces.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/convex_solid.h>

#include <span>

namespace lefort::mesh {

/// Both parts are closed and counter-clockwise seen from outside; either may be empty. Where they
/// meet, the caps have the same triangles, turned round, on vertices of equal coordinates.
struct SurfaceCut {
  geometry::TriangleMesh inside;   ///< Within all half-spaces.
  geometry::TriangleMesh outside;  ///< The rest.
  double whole_volume_mm3 = 0.0;
  double inside_volume_mm3 = 0.0;
  double outside_volume_mm3 = 0.0;
  double plane_shift_mm = 0.0;  ///< How far the planes were moved inwards for the cut to succeed.
};

/// Splits `surface` by the intersection of `half_spaces`.
///
/// The surface is repaired first (mesh/repair_surface.h), so it may come from marching cubes.
///
/// \param surface       closed once repaired; the same frame as the half-spaces.
/// \param half_spaces   one or more.
/// \returns both parts, or
///   - kInvalidArgument  no half-space, one that is not finite, or a normal of length zero;
///   - kMeshInvalid      the surface is empty, not finite, or open (the message names an edge);
///   - kMeshingFailed    it crosses itself along the cut, also after shifting the planes by up to
///     1e-4 mm, the parts' volumes miss the whole by more than 0.1 %, or the memory is too small;
///   - kCancelled        `progress` asked to stop.
/// \note Intersection points are computed exactly, then rounded \cite cgal:lty-pmp, chapter
///   "Corefinement and Boolean Operations". Same input, same bits.
[[nodiscard]] Result<SurfaceCut> cut_surface(const geometry::TriangleMesh& surface,
                                             std::span<const HalfSpace> half_spaces,
                                             Progress& progress = Progress::none());

/// The same by any closed surface: what lies within `solid`, and the rest.
///
/// \param solid  closed, counter-clockwise seen from outside, not crossing itself; may be empty.
/// \returns as above; where the cut runs through a flaw of the surface the solid is moved by up to
///   1e-4 mm.
[[nodiscard]] Result<SurfaceCut> cut_surface(const geometry::TriangleMesh& surface,
                                             const geometry::TriangleMesh& solid,
                                             Progress& progress = Progress::none());

}  // namespace lefort::mesh
