/// \file
/// Inside or outside, without asking which triangle is nearest.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::geometry {

/// How often `surface` winds around p: 1 inside a closed surface that faces outwards, 0 outside; in
/// between near the hole of an open one. The sum of the triangles' solid angles over 4 pi
/// \cite vanoosterom1983.
///
/// Takes time in proportion to the triangles. Knows nothing of nearest features, so it tells the
/// side also where the surface cuts through itself and pseudonormals may be wrong.
[[nodiscard]] double winding_number(const TriangleMesh& surface, const Vec3& p);

}  // namespace lefort::geometry
