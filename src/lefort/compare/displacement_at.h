/// \file
/// Interpolates the displacement of a surface at one of its points.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <span>

namespace lefort::compare {

/// Linear interpolation in a triangle.
///
/// \param surface_L        before the displacement.
/// \param triangle         number of the triangle.
/// \param p_L              a point of it [mm].
/// \param displacement_mm  one per vertex.
/// \returns the displacement at the point [mm]; for a triangle without area, by least squares.
[[nodiscard]] Vec3 displacement_at(const geometry::TriangleMesh& surface_L, Index triangle,
                                   const Vec3& p_L, std::span<const Vec3> displacement_mm);

}  // namespace lefort::compare
