#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/mesh/internal/limit_thickness.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace lefort::mesh::internal {
namespace {

// Heuristic values, without a source in the literature.
// Of the distance through the body: two opposite layers leave a third of it between them.
constexpr double kMaxBodyFraction = 1.0 / 3.0;
// Change of the thickness over distance: the inner surface is inclined by at most 27 degrees.
constexpr double kMaxThicknessSlope = 0.5;
// Start of a ray below the surface, of the thickness, so that it misses the faces around the node.
constexpr double kRayStart = 0.1;

/// \returns the distance from the node to the opposite boundary along its direction [mm], 0 if the
/// ray meets none.
double distance_through_body_mm(const LayerSurface& surface, const geometry::Bvh& body,
                                const LayerConstraints& constraints, std::size_t node,
                                const Vec3& inwards, double thickness_mm) {
  const double start_mm = kRayStart * thickness_mm;
  // A ray along a cut plane would hit the cut faces, which lie in their plane within kOnPlane_mm.
  Vec3 from_L = surface.nodes_L[node] + start_mm * inwards;
  for (const Vec3& inside : constraints.blocked_directions(node))
    from_L += std::max(start_mm, 2.0 * kOnPlane_mm) * inside;
  const auto opposite = body.first_hit(from_L, inwards);
  return opposite ? opposite->distance_mm + start_mm : 0.0;
}

/// Reduces thicknesses until the slope between two nodes of a face is at most kMaxThicknessSlope.
/// Relaxation of shortest paths (Bellman-Ford): at most as many sweeps as there are nodes.
void limit_slope(const LayerSurface& surface, std::vector<double>& thickness_mm) {
  bool is_changed = true;
  while (is_changed) {
    is_changed = false;
    for (const Face3& face : surface.faces)
      for (const std::int32_t a : face)
        for (const std::int32_t b : face) {
          double& at_a_mm = thickness_mm[std::size_t(a)];
          const double max_mm =
              thickness_mm[std::size_t(b)] +
              kMaxThicknessSlope *
                  (surface.nodes_L[std::size_t(a)] - surface.nodes_L[std::size_t(b)]).norm();
          if (!(at_a_mm > max_mm)) continue;
          at_a_mm = max_mm;
          is_changed = true;
        }
  }
}

}  // namespace

std::vector<double> limited_thickness_mm(const LayerSurface& surface,
                                         const std::vector<Face3>& boundary,
                                         const LayerConstraints& constraints,
                                         std::span<const Vec3> inwards, double thickness_mm) {
  std::vector<double> limited_mm(surface.nodes_L.size(), 0.0);
  const geometry::Bvh body({surface.nodes_L, boundary});
  parallel_for(Index(surface.nodes_L.size()), [&](Index n) {
    const auto node = std::size_t(n);
    if (surface.faces_of_node.of(node).empty() || constraints.is_layer_boundary(node) ||
        inwards[node].isZero())
      return;
    const double through_mm =
        distance_through_body_mm(surface, body, constraints, node, inwards[node], thickness_mm);
    limited_mm[node] = std::min(thickness_mm, kMaxBodyFraction * through_mm);
  });
  limit_slope(surface, limited_mm);
  return limited_mm;
}

}  // namespace lefort::mesh::internal
