/// \file
/// Bounding volume hierarchy of a surface: closest point, signed distance, ray intersections.
#pragma once

#include <lefort/geometry/closest_point.h>
#include <lefort/geometry/pseudonormals.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace lefort::geometry {

/// Closest point of a surface.
struct SurfacePoint {
  Vec3 point;
  double distance_mm;  ///< >= 0.
  Index triangle;      ///< The lowest number among triangles at equal distance.
  Feature feature;     ///< Of that triangle, where the point lies.
};

struct SignedDistance {
  double distance_mm;  ///< Negative inside (docs/conventions.md).
  SurfacePoint nearest;
  Vec3 pseudonormal;  ///< At the closest feature; not of unit length.
};

struct RayHit {
  double distance_mm;  ///< From the origin along the unit direction, >= 0.
  Index triangle;
};

/// Bounding volume hierarchy with exact queries; stores a copy of the surface. Queries from several
/// threads are safe, and their results do not depend on the number of threads.
class Bvh {
 public:
  /// \param mesh  for signs it should be closed, and welded (weld_vertices) if positions repeat.
  /// \pre check_surface(mesh) succeeds.
  explicit Bvh(TriangleMesh mesh);

  /// Closest point of the surface.
  ///
  /// \param p                query point [mm].
  /// \param max_distance_mm  search radius.
  /// \returns nothing if the surface is further than `max_distance_mm` away, or `p` is not finite.
  [[nodiscard]] std::optional<SurfacePoint> closest_point(
      const Vec3& p, double max_distance_mm = std::numeric_limits<double>::infinity()) const;

  /// Distance with the sign of the pseudonormal at the closest feature \cite baerentzen2005.
  ///
  /// \param p  query point [mm]. \pre it is finite.
  [[nodiscard]] SignedDistance signed_distance(const Vec3& p) const;

  /// First triangle that a ray hits, from either side. Triangles parallel to the ray or without
  /// area are not hit.
  ///
  /// \param origin     start of the ray [mm].
  /// \param direction  need not have unit length. \pre it is not zero.
  [[nodiscard]] std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction) const;

  /// Number of triangles that a ray crosses. For a closed surface and a ray in general position an
  /// odd number means inside; a ray through an edge may count both triangles.
  ///
  /// \param origin     start of the ray [mm].
  /// \param direction  need not have unit length. \pre it is not zero.
  [[nodiscard]] Index count_hits(const Vec3& origin, const Vec3& direction) const;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] const Pseudonormals& pseudonormals() const { return pseudonormals_; }

  /// Memory of the tree, without surface and pseudonormals.
  [[nodiscard]] std::size_t tree_bytes() const;

 private:
  struct Node {
    Vec3 low, high;
    std::int32_t first;  ///< Leaf: first position in order_. Branch: second child.
    std::int32_t count;  ///< Leaf: number of triangles. Branch: 0; the first child is next.
  };

  void build(const std::vector<Vec3>& centers, std::int32_t begin, std::int32_t end);
  template <class OnTriangle>
  void visit_ray(const Vec3& origin, const Vec3& direction, const OnTriangle& on_triangle) const;

  TriangleMesh mesh_;
  Pseudonormals pseudonormals_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace lefort::geometry
