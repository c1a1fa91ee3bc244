/// \file
/// Winding number: decides inside or outside without the closest point.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::geometry {

/// Winding number of `surface` around p: 1 inside a closed surface that is oriented outward, 0
/// outside, between 0 and 1 near a hole of an open surface. It is the sum of the solid angles of
/// the triangles divided by 4 pi \cite vanoosterom1983.
///
/// The time is proportional to the number of triangles. The result is also valid where the surface
/// intersects itself and pseudonormals may be wrong.
///
/// \param surface  any triangle soup.
/// \param p        query point [mm].
[[nodiscard]] double winding_number(const TriangleMesh& surface, const Vec3& p);

}  // namespace lefort::geometry
