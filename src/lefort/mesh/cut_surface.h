/// \file
/// Splits a closed surface into two by a solid: an intersection of half-spaces, or the inside of
/// another closed surface.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/convex_solid.h>

#include <span>

namespace lefort::mesh {

/// Both parts are closed and counter-clockwise seen from outside; either may be empty. On the
/// common cap they have the same triangles with opposite orientation, on vertices of equal
/// coordinates.
struct SurfaceCut {
  geometry::TriangleMesh inside;   ///< Part in all half-spaces, or in the solid.
  geometry::TriangleMesh outside;  ///< The other part.
  double whole_volume_mm3 = 0.0;
  double inside_volume_mm3 = 0.0;
  double outside_volume_mm3 = 0.0;
  /// Displacement of the planes (inwards) or of the solid with which the cut succeeded; 0: none.
  double plane_shift_mm = 0.0;
};

/// Splits `surface` by the intersection of `half_spaces`.
///
/// The surface is repaired first (mesh/repair_surface.h), so it may come from marching cubes.
///
/// \param surface       closed once repaired; the same frame as the half-spaces.
/// \param half_spaces   one or more.
/// \param progress      receives the fraction of attempts done; may request a stop.
/// \returns both parts, or
///   - kInvalidArgument  no half-space, one that is not finite, or a normal of length zero;
///   - kMeshInvalid      as repair_surface(): for example the surface is open;
///   - kMeshingFailed    the surface crosses itself along the cut, even after the planes were
///     displaced by up to 0.01 mm; the volumes of the parts do not add up within 0.1 %; or memory
///     is exhausted;
///   - kCancelled        `progress` requested a stop.
/// \note Intersection points are computed exactly, then rounded \cite cgal:lty-pmp, chapter
///   "Corefinement and Boolean Operations". Same input, same bits.
[[nodiscard]] Result<SurfaceCut> cut_surface(const geometry::TriangleMesh& surface,
                                             std::span<const HalfSpace> half_spaces,
                                             Progress& progress = Progress::none());

/// Splits `surface` by any closed surface: the parts inside and outside `solid`.
///
/// \param surface   closed once repaired; the same frame as `solid`.
/// \param solid     closed, counter-clockwise seen from outside, not crossing itself; may be empty.
/// \param progress  receives the fraction of attempts done; may request a stop.
/// \returns as above, except kInvalidArgument. If the cut passes through a defect of the surface,
///   the solid is displaced by up to 0.01 mm.
[[nodiscard]] Result<SurfaceCut> cut_surface(const geometry::TriangleMesh& surface,
                                             const geometry::TriangleMesh& solid,
                                             Progress& progress = Progress::none());

}  // namespace lefort::mesh
