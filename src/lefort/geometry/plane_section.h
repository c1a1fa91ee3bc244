/// \file
/// Where a plane cuts a surface.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <vector>

namespace lefort::geometry {

/// Pieces of the section with the plane where the coordinate `axis` (0 x, 1 y, 2 z) is `at_mm`, one
/// for each triangle that crosses it. A vertex in the plane counts as above, so a closed surface
/// gives closed lines, and a triangle in the plane nothing.
[[nodiscard]] std::vector<std::array<Vec3, 2>> plane_section(const TriangleMesh& mesh, int axis,
                                                             double at_mm);

}  // namespace lefort::geometry
