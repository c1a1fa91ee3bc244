/// \file
/// Triangle surface mesh.
#pragma once

#include <lefort/core/types.h>

#include <array>
#include <cstdint>
#include <vector>

namespace lefort::geometry {

/// Vertex numbers, counter-clockwise seen from outside.
using Triangle = std::array<std::int32_t, 3>;

/// Any triangle soup; functions that need a closed or oriented surface document and check this.
struct TriangleMesh {
  std::vector<Vec3> vertices;  ///< [mm], in the frame that the name of the variable states.
  std::vector<Triangle> triangles;

  [[nodiscard]] Index vertex_count() const { return Index(vertices.size()); }
  [[nodiscard]] Index triangle_count() const { return Index(triangles.size()); }
  [[nodiscard]] const Vec3& corner(Index triangle, int corner) const {
    return vertices[std::size_t(triangles[std::size_t(triangle)][std::size_t(corner)])];
  }
};

}  // namespace lefort::geometry
