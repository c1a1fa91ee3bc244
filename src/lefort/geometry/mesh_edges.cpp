#include <lefort/geometry/mesh_edges.h>

#include <algorithm>

namespace lefort::geometry {

namespace {

struct HalfEdge {
  std::int32_t larger;
  EdgeUse use;
};

/// Sides of all triangles, by smaller vertex (bucket v is [first[v], first[v + 1])), then by larger
/// vertex, then by triangle.
std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh, std::vector<std::size_t>& first) {
  first.assign(mesh.vertices.size() + 1, 0);
  for (const Triangle& t : mesh.triangles)
    for (std::size_t side = 0; side < 3; ++side)
      ++first[std::size_t(std::min(t[side], t[(side + 1) % 3])) + 1];
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) first[v + 1] += first[v];

  std::vector<HalfEdge> sorted(3 * mesh.triangles.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t side = 0; side < 3; ++side) {
      const std::int32_t from = mesh.triangles[t][side];
      const std::int32_t to = mesh.triangles[t][(side + 1) % 3];
      sorted[next[std::size_t(std::min(from, to))]++] = {
          std::max(from, to), {std::int32_t(t), std::int8_t(side), from <= to}};
    }
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    std::stable_sort(sorted.begin() + std::ptrdiff_t(first[v]),
                     sorted.begin() + std::ptrdiff_t(first[v + 1]),
                     [](const HalfEdge& x, const HalfEdge& y) { return x.larger < y.larger; });
  return sorted;
}

}  // namespace

MeshEdges find_edges(const TriangleMesh& mesh) {
  std::vector<std::size_t> first;
  const std::vector<HalfEdge> sorted = sorted_half_edges(mesh, first);

  MeshEdges edges;
  edges.uses.reserve(sorted.size());
  edges.of_triangle.resize(mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (std::size_t i = first[v]; i < first[v + 1]; ++i) {
      if (i == first[v] || sorted[i].larger != sorted[i - 1].larger) {
        edges.ends.push_back({std::int32_t(v), sorted[i].larger});
        edges.first_use.push_back(std::int32_t(edges.uses.size()));
      }
      const EdgeUse& use = sorted[i].use;
      edges.of_triangle[std::size_t(use.triangle)][std::size_t(use.side)] =
          std::int32_t(edges.ends.size()) - 1;
      edges.uses.push_back(use);
    }
  }
  edges.first_use.push_back(std::int32_t(edges.uses.size()));
  return edges;
}

}  // namespace lefort::geometry
