/// \file
/// Solids by which surfaces are cut: union and intersection of closed surfaces, and prisms.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>

namespace lefort::mesh {

/// \param a, b  closed surfaces; either may be empty.
/// \returns the boundary of the union, a closed surface; or kMeshingFailed if a surface crosses
///   itself or both touch along an edge.
[[nodiscard]] Result<geometry::TriangleMesh> unite(const geometry::TriangleMesh& a,
                                                   const geometry::TriangleMesh& b);

/// \param a, b  closed surfaces; either may be empty.
/// \returns the boundary of the intersection, empty if there is no common volume; or kMeshingFailed
///   if a surface crosses itself or both touch along an edge.
[[nodiscard]] Result<geometry::TriangleMesh> intersect(const geometry::TriangleMesh& a,
                                                       const geometry::TriangleMesh& b);

/// Extrudes a closed curve, projected along a direction, between two heights; both ends are flat.
///
/// \param curve             three points or more, in order; the last is joined to the first.
/// \param direction         not zero.
/// \param from_mm, to_mm    heights: p . direction, with the direction normalized; from < to.
/// \param grow_mm           offset of the sides outwards, >= 0; corners are mitered, by at most
///   four times the offset.
/// \returns a closed surface; or kInvalidArgument if there are fewer points, a point or the
///   direction is not finite, the direction is zero, or the projected curve crosses or touches
///   itself before or after the offset.
[[nodiscard]] Result<geometry::TriangleMesh> make_prism(std::span<const Vec3> curve,
                                                        const Vec3& direction, double from_mm,
                                                        double to_mm, double grow_mm = 0.0);

}  // namespace lefort::mesh
