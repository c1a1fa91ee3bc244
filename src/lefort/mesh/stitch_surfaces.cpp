#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/internal/disjoint_sets.h>
#include <lefort/mesh/stitch_surfaces.h>

#include <algorithm>
#include <map>

namespace lefort::mesh {
namespace {

using geometry::Triangle;
using geometry::TriangleMesh;
using Corners = std::array<std::array<double, 3>, 3>;

Corners corners_of(const TriangleMesh& mesh, const Triangle& triangle) {
  Corners corners{};
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3& p = mesh.vertices[std::size_t(triangle[c])];
    corners[c] = {p.x(), p.y(), p.z()};
  }
  return corners;
}

/// Rotates a triangle so that the vertex with the smallest coordinates comes first.
Triangle smallest_first(const TriangleMesh& mesh, Triangle triangle) {
  const Corners corners = corners_of(mesh, triangle);
  const auto smallest = std::min_element(corners.begin(), corners.end()) - corners.begin();
  std::rotate(triangle.begin(), triangle.begin() + smallest, triangle.end());
  return triangle;
}

}  // namespace

TriangleMesh stitch_surfaces(const TriangleMesh& a, const TriangleMesh& b) {
  std::map<Corners, Index> b_flipped;  // Each triangle of b with opposite orientation.
  for (Index t = 0; t < b.triangle_count(); ++t) {
    const auto& [p, q, r] = b.triangles[std::size_t(t)];
    const Triangle flipped = smallest_first(b, {p, r, q});
    b_flipped.emplace(corners_of(b, flipped), t);
  }

  // Vertices of b follow those of a; those on a common cap merge with their matches in a. A vertex
  // of b may match two of a: pieces of a that touch at a point of the cap have a vertex each.
  internal::DisjointSets merged(a.vertices.size() + b.vertices.size());
  const auto first_of_b = a.vertices.size();
  std::vector<bool> dropped(b.triangles.size(), false);
  TriangleMesh joined;
  joined.vertices = a.vertices;
  for (const Triangle& triangle : a.triangles) {
    const Triangle first = smallest_first(a, triangle);
    const auto match = b_flipped.find(corners_of(a, first));
    if (match == b_flipped.end()) {
      joined.triangles.push_back(triangle);
      continue;
    }
    const auto t = std::size_t(match->second);
    dropped[t] = true;
    const auto& [p, q, r] = b.triangles[t];
    const Triangle flipped = smallest_first(b, {p, r, q});
    for (std::size_t c = 0; c < 3; ++c)
      merged.unite(std::size_t(first[c]), first_of_b + std::size_t(flipped[c]));
    b_flipped.erase(match);
  }

  joined.vertices.insert(joined.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (std::size_t t = 0; t < b.triangles.size(); ++t) {
    if (dropped[t]) continue;
    Triangle triangle = b.triangles[t];
    for (std::int32_t& vertex : triangle) vertex += std::int32_t(first_of_b);
    joined.triangles.push_back(triangle);
  }
  for (Triangle& triangle : joined.triangles)
    for (std::int32_t& vertex : triangle) vertex = std::int32_t(merged.find(std::size_t(vertex)));
  return geometry::keep_triangles(joined, [](Index) { return true; });  // Removes unused vertices.
}

}  // namespace lefort::mesh
