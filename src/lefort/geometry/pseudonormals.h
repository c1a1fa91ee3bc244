/// \file
/// Normals at faces, edges and vertices that tell inside from outside at the nearest feature.
#pragma once

#include <lefort/geometry/closest_point.h>
#include <lefort/geometry/edge_incidence.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace lefort::geometry {

/// Let c be the point of a closed surface nearest to p, on some feature with pseudonormal N. Then
/// p lies outside exactly if N . (p - c) > 0 \cite baerentzen2005, which no face normal achieves at
/// edges and vertices. The sums run over all faces there: so that is right where a surface touches
/// itself, too, at a vertex with several fans of triangles or an edge of four.
///
/// Those of edges and of most vertices are worked out when asked for: stored, they would outweigh
/// the surface, and few are.
class Pseudonormals {
 public:
  Pseudonormals() = default;

  /// Of any soup: open, non-manifold, with triangles without area.
  ///
  /// Vertices are told apart by number, so weld_vertices() first if equal positions were written
  /// more than once. A triangle without area has no normal of its own; seen from one of its edges
  /// or corners it is an extension of the triangle beyond it, so that the caps and needles of a
  /// triangulation do not turn the sign of their neighbors.
  /// \pre check_surface(mesh) holds.
  explicit Pseudonormals(const TriangleMesh& mesh) : Pseudonormals(mesh, EdgeIncidence(mesh)) {}
  Pseudonormals(const TriangleMesh& mesh, const EdgeIncidence& sides);

  /// At a face: unit, zero without area. At an edge: sum of the unit normals of the faces there. At
  /// a vertex: unit, or zero where normals cancel (paper, equation 1).
  ///
  /// \param mesh  what this was computed from.
  [[nodiscard]] Vec3 at(const TriangleMesh& mesh, Index triangle, Feature feature) const;

  [[nodiscard]] Vec3 at_vertex(const TriangleMesh& mesh, Index vertex) const;

 private:
  /// The triangles at a vertex.
  struct Corners {
    std::int32_t first = -1;  ///< 3 * triangle + corner; ~ the place in of_irregular_vertex_.
    std::int32_t count = 0;
  };

  void find_corners(const TriangleMesh& mesh, const EdgeIncidence& sides);

  template <class Body>
  bool walk_around(const TriangleMesh& mesh, std::int32_t vertex, const Body& body) const;

  std::vector<Vec3> of_face_;
  std::vector<Corners> at_vertex_;
  std::vector<Vec3> of_irregular_vertex_;
  /// By triangle and side: the one triangle beyond it, or ~ the place in of_irregular_edge_ if
  /// there are none or several, or one of the two is without area.
  std::vector<std::array<std::int32_t, 3>> opposite_triangle_;
  std::vector<Vec3> of_irregular_edge_;
};

/// \returns zero for a triangle without area.
[[nodiscard]] Vec3 face_normal(const TriangleMesh& mesh, Index triangle);

}  // namespace lefort::geometry
