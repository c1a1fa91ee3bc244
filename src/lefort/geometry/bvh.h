/// \file
/// A tree of boxes over a surface: nearest point, signed distance, ray hits.
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

/// The point of a surface nearest to a query.
struct SurfacePoint {
  Vec3 point;
  double distance_mm;  ///< >= 0.
  Index triangle;      ///< The lowest number among triangles equally near.
  Feature feature;     ///< Of that triangle.
};

struct SignedDistance {
  double distance_mm;  ///< Negative inside (docs/conventions.md).
  SurfacePoint nearest;
  Vec3 pseudonormal;  ///< At the nearest feature; not of unit length.
};

struct RayHit {
  double distance_mm;  ///< From the origin along the unit direction, >= 0.
  Index triangle;
};

/// Box tree with exact queries; holds its own copy of the surface. Safe for queries from many
/// threads; answers do not depend on them.
class Bvh {
 public:
  /// \pre check_surface(mesh) holds. For signs the surface should be closed, and welded
  ///   (weld_vertices) if positions repeat.
  explicit Bvh(TriangleMesh mesh);

  /// \returns nothing if the surface is further than `max_distance_mm` away, or `p` is not finite.
  [[nodiscard]] std::optional<SurfacePoint> closest_point(
      const Vec3& p, double max_distance_mm = std::numeric_limits<double>::infinity()) const;

  /// Distance with the sign of the pseudonormal at the nearest feature. \pre `p` is finite.
  [[nodiscard]] SignedDistance signed_distance(const Vec3& p) const;

  /// First triangle hit by the ray, from either side; grazing a triangle without area is no hit.
  /// \pre `direction` is not zero.
  [[nodiscard]] std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction) const;

  /// How many triangles the ray crosses; odd means inside, for a closed surface and a ray in
  /// general position (one through an edge may count both triangles there).
  [[nodiscard]] Index count_hits(const Vec3& origin, const Vec3& direction) const;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] const Pseudonormals& pseudonormals() const { return pseudonormals_; }

  /// Memory of the tree itself, without surface and pseudonormals.
  [[nodiscard]] std::size_t tree_bytes() const;

 private:
  struct Node {
    Vec3 low, high;
    std::int32_t first;  ///< First triangle in order_ of a leaf, else the second child.
    std::int32_t count;  ///< Triangles of a leaf; 0 for a branch, whose first child follows it.
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
