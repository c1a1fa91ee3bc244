/// \file
/// A tree of boxes over triangles, to ask for the nearest of many points at once.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace lefort::field {

struct TriangleTree {
  static constexpr std::int32_t kLeafTriangles = 8;
  /// Halving 2^31 triangles gives 31 levels; a depth-first walk keeps one node of each.
  static constexpr std::size_t kStackSize = 64;

  /// A branch's first child follows it.
  struct Node {
    std::array<float, 3> low, high;  ///< Relative to `origin`; contains the triangles.
    std::int32_t first;              ///< Of a leaf in `order`, else the second child.
    std::int32_t count;              ///< Triangles of a leaf; 0 for a branch.
  };

  Vec3 origin;
  std::vector<Node> nodes;
  std::vector<std::int32_t> order;  ///< Triangles by leaf.
};

/// Halves the triangles at the median of their centers along the longest side, again and again.
///
/// \param mesh    \pre not empty, finite.
/// \param origin  near the mesh: boxes are in single precision, widened by its rounding.
[[nodiscard]] TriangleTree build_triangle_tree(const geometry::TriangleMesh& mesh,
                                               const Vec3& origin);

/// Squared distance of `p` from the nearest triangle [mm^2], or infinity if that is further than
/// `reach_mm`.
[[nodiscard]] double squared_distance(const geometry::TriangleMesh& mesh, const TriangleTree& tree,
                                      const Vec3& p, double reach_mm);

}  // namespace lefort::field
