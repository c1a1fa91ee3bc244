/// \file
/// Properties that tests check on surfaces.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <map>
#include <utility>

namespace lefort::test {

/// Edges that do not have exactly two triangles, one in each direction.
inline Index count_bad_edges(const geometry::TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const geometry::Triangle& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) ++edges[{t[c], t[(c + 1) % 3]}];
  Index bad = 0;
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    bad += count != 1 || back == edges.end() ? 1 : 0;
  }
  return bad;
}

inline Vec3 area_vector(const geometry::TriangleMesh& mesh, Index t) {
  return 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
}

inline double area(const geometry::TriangleMesh& mesh) {
  double sum = 0.0;
  for (Index t = 0; t < mesh.triangle_count(); ++t) sum += area_vector(mesh, t).norm();
  return sum;
}

/// Positive if triangles are counter-clockwise seen from outside.
inline double volume(const geometry::TriangleMesh& mesh) {
  double sum = 0.0;
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    sum += area_vector(mesh, t).dot(mesh.corner(t, 0)) / 3.0;
  return sum;
}

/// Vertices - edges + faces: 2 for a sphere, 0 for a torus.
inline Index euler_number(const geometry::TriangleMesh& mesh) {
  return mesh.vertex_count() - mesh.triangle_count() / 2;
}

}  // namespace lefort::test
