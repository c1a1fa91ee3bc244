/// \file
/// Intersection of a surface with a plane normal to an axis.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <vector>

namespace lefort::geometry {

/// Segments of the intersection, one for each triangle that crosses the plane. A vertex in the
/// plane counts as above it. So a closed surface gives closed lines, and a triangle in the plane
/// gives no line.
///
/// \param mesh   any triangle soup.
/// \param axis   normal of the plane: 0 x, 1 y, 2 z.
/// \param at_mm  coordinate of the plane along the axis.
[[nodiscard]] std::vector<std::array<Vec3, 2>> plane_section(const TriangleMesh& mesh, int axis,
                                                             double at_mm);

}  // namespace lefort::geometry
