/// \file
/// Angle-weighted pseudonormals of faces, edges and vertices, which decide the sign of distances.
#pragma once

#include <lefort/geometry/closest_point.h>
#include <lefort/geometry/edge_incidence.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace lefort::geometry {

/// Let c be the point of a closed surface closest to p, on a feature with pseudonormal N. Then p
/// lies outside exactly if N . (p - c) > 0 \cite baerentzen2005. Face normals do not have this
/// property at edges and vertices. Sums include all faces at a feature, so signs are also right
/// where a surface touches itself: at vertices with several fans of triangles and at edges with
/// four triangles.
///
/// Pseudonormals of most edges and vertices are computed on demand: they would need more memory
/// than the surface, and only few are used.
class Pseudonormals {
 public:
  Pseudonormals() = default;

  /// Accepts any triangle soup: open, non-manifold, with triangles without area.
  ///
  /// Vertices are identified by number, so call weld_vertices() first if positions repeat. A
  /// triangle without area has no normal; at its edges and corners the normal of the neighbor that
  /// it extends is used instead. A cap (three collinear corners) extends the neighbor at its
  /// longest edge; a needle (one very short edge) extends those at its long edges. Neither then
  /// changes the signs of its neighbors.
  ///
  /// \param mesh   the surface.
  /// \param edges  its edges.
  /// \pre check_surface(mesh) succeeds: valid vertex numbers and coordinates.
  explicit Pseudonormals(const TriangleMesh& mesh) : Pseudonormals(mesh, EdgeIncidence(mesh)) {}
  Pseudonormals(const TriangleMesh& mesh, const EdgeIncidence& edges);

  /// Pseudonormal of a feature. Face: unit normal, zero without area. Edge: sum of the unit normals
  /// of its faces. Vertex: unit vector (\cite lefort-paper, equation 1). Zero where the normals of
  /// an edge or a vertex cancel.
  ///
  /// \param mesh      the surface given to the constructor.
  /// \param triangle  number of a triangle at the feature.
  /// \param feature   of that triangle.
  [[nodiscard]] Vec3 at(const TriangleMesh& mesh, Index triangle, Feature feature) const;

  /// Pseudonormal of a vertex: a unit vector, or zero where normals cancel or no triangle uses it.
  [[nodiscard]] Vec3 at_vertex(const TriangleMesh& mesh, Index vertex) const;

 private:
  /// The triangles at a vertex.
  struct Corners {
    /// 3 * triangle + corner; or the bitwise complement of a position in of_irregular_vertex_.
    std::int32_t first = -1;
    std::int32_t count = 0;
  };

  void find_corners(const TriangleMesh& mesh, const EdgeIncidence& edges);

  template <class Body>
  bool walk_around(const TriangleMesh& mesh, std::int32_t vertex, const Body& body) const;

  std::vector<Vec3> of_face_;
  std::vector<Corners> at_vertex_;
  std::vector<Vec3> of_irregular_vertex_;
  /// By triangle and side: the triangle beyond the edge, or the bitwise complement of a position in
  /// of_irregular_edge_ if
  /// there is none, there are several, or one of the two has no area.
  std::vector<std::array<std::int32_t, 3>> opposite_triangle_;
  std::vector<Vec3> of_irregular_edge_;
};

/// \returns the unit normal of a triangle, zero without area.
[[nodiscard]] Vec3 face_normal(const TriangleMesh& mesh, Index triangle);

}  // namespace lefort::geometry
