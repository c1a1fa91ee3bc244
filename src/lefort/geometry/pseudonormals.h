/// \file
/// Normals at faces, edges and vertices that tell inside from outside at the nearest feature.
#pragma once

#include <lefort/geometry/closest_point.h>
#include <lefort/geometry/mesh_edges.h>
#include <lefort/geometry/triangle_mesh.h>

#include <vector>

namespace lefort::geometry {

/// Let c be the point of a closed surface nearest to p, on some feature with pseudonormal N. Then
/// p lies outside exactly if N . (p - c) > 0 \cite baerentzen2005, which no face normal achieves at
/// edges and vertices.
struct Pseudonormals {
  std::vector<Vec3> of_face;    ///< Unit; zero for a triangle without area.
  std::vector<Vec3> of_edge;    ///< Sum of the unit normals of the faces there, by edge number.
  std::vector<Vec3> of_vertex;  ///< Unit, or zero where normals cancel (paper, equation 1).
  MeshEdges edges;

  /// \param triangle  of the `mesh` this was computed from.
  [[nodiscard]] const Vec3& at(const TriangleMesh& mesh, Index triangle, Feature feature) const;
};

/// Computes the pseudonormals of any soup: open, non-manifold, with triangles without area.
///
/// Vertices are told apart by number, so weld_vertices() first if equal positions were written more
/// than once. A triangle without area has no normal of its own; seen from one of its edges or
/// corners it is an extension of the triangle beyond it, so that the caps and needles of a
/// triangulation do not turn the sign of their neighbours.
/// \pre check_surface(mesh) holds.
[[nodiscard]] Pseudonormals compute_pseudonormals(const TriangleMesh& mesh);

}  // namespace lefort::geometry
