/// \file
/// A bounding volume hierarchy for nearest triangles of several points at once.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace lefort::field {

/// Bounding volume hierarchy of triangles, in single precision.
struct TriangleTree {
  static constexpr std::int32_t kLeafTriangles = 8;
  /// 2^31 triangles give 31 levels; a depth-first traversal keeps one node per level.
  static constexpr std::size_t kStackSize = 64;

  /// A leaf or a branch. The first child of a branch is the next node.
  struct Node {
    std::array<float, 3> low, high;  ///< Relative to `origin`; contains the triangles.
    std::int32_t first;              ///< Leaf: first position in `order`. Branch: second child.
    std::int32_t count;              ///< Leaf: number of triangles. Branch: 0.
  };

  Vec3 origin;
  std::vector<Node> nodes;
  std::vector<std::int32_t> order;  ///< Triangles by leaf.
};

/// Builds a tree by recursive division at the median of the centers along the longest axis.
///
/// \param mesh    \pre not empty, finite.
/// \param origin  near the mesh: boxes are in single precision, with a margin for rounding.
[[nodiscard]] TriangleTree build_triangle_tree(const geometry::TriangleMesh& mesh,
                                               const Vec3& origin);

/// Squared distance of `p` from the nearest triangle [mm^2], or infinity if it is further than
/// `max_distance_mm`.
///
/// \param mesh             the surface.
/// \param tree             of `mesh`.
/// \param p                query point [mm].
/// \param max_distance_mm  max distance.
[[nodiscard]] double squared_distance(const geometry::TriangleMesh& mesh, const TriangleTree& tree,
                                      const Vec3& p, double max_distance_mm);

}  // namespace lefort::field
