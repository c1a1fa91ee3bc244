/// \file
/// Bodies of a closed surface: each an outer shell with the cavities in it. For this layer.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <vector>

namespace lefort::plan {

/// One piece of bone.
struct BoneBody {
  geometry::TriangleMesh surface;  ///< The outer shell, then the shells of its cavities.
  double outer_volume_mm3 = 0.0;   ///< Cavities counted in.
  double volume_mm3 = 0.0;         ///< Cavities left out.
};

/// The bodies in the order of their outer shells' first triangles. A cavity belongs to the smallest
/// outer shell around it.
[[nodiscard]] std::vector<BoneBody> bodies_of(const geometry::TriangleMesh& surface);

/// The surfaces of some bodies as one mesh, not joined.
[[nodiscard]] geometry::TriangleMesh gather(std::span<const BoneBody> bodies,
                                            const std::vector<bool>& chosen);

/// Appends a surface, not joined.
void append(geometry::TriangleMesh& to, const geometry::TriangleMesh& more);

}  // namespace lefort::plan
