/// \file
/// Cutters from simpler cutters: union and intersection of closed surfaces, and prisms.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>

namespace lefort::mesh {

/// What lies in a or b. Either may be empty.
///
/// \returns a closed surface, or kMeshingFailed if a surface crosses itself.
[[nodiscard]] Result<geometry::TriangleMesh> unite(const geometry::TriangleMesh& a,
                                                   const geometry::TriangleMesh& b);

/// What lies in a and b; empty if they have no volume in common.
[[nodiscard]] Result<geometry::TriangleMesh> intersect(const geometry::TriangleMesh& a,
                                                       const geometry::TriangleMesh& b);

/// A closed curve as seen along a direction, moved along it between two heights: flat at both ends.
///
/// \param curve             three points or more, in order; the last is joined to the first.
/// \param direction         not zero.
/// \param from_mm, to_mm    heights, p . direction of unit length; from < to.
/// \param grow_mm           moves the walls outwards, corners mitred.
/// \returns kInvalidArgument if there are fewer points, one is not finite, or the curve crosses or
///   touches itself seen along the direction, before or after it has grown.
[[nodiscard]] Result<geometry::TriangleMesh> make_prism(std::span<const Vec3> curve,
                                                        const Vec3& direction, double from_mm,
                                                        double to_mm, double grow_mm = 0.0);

}  // namespace lefort::mesh
