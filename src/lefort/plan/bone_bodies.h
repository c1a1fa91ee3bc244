/// \file
/// Splits a closed surface into bodies: outer shells with their cavities.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <vector>

namespace lefort::plan {

/// One piece of bone.
struct BoneBody {
  geometry::TriangleMesh surface;  ///< The outer shell, then the shells of its cavities.
  double outer_volume_mm3 = 0.0;   ///< Including cavities.
  double volume_mm3 = 0.0;         ///< Without cavities.
};

/// A cavity belongs to the smallest outer shell around it.
///
/// \param surface  closed.
/// \returns the bodies, in the order of the first triangles of their outer shells.
[[nodiscard]] std::vector<BoneBody> bodies_of(const geometry::TriangleMesh& surface);

/// \param bodies  as returned by bodies_of().
/// \param chosen  one entry per body.
/// \returns the surfaces of the chosen bodies as one mesh, not stitched.
[[nodiscard]] geometry::TriangleMesh gather(std::span<const BoneBody> bodies,
                                            const std::vector<bool>& chosen);

/// Appends a surface without stitching it.
///
/// \param to    the surface that grows.
/// \param more  the surface to append.
void append(geometry::TriangleMesh& to, const geometry::TriangleMesh& more);

}  // namespace lefort::plan
