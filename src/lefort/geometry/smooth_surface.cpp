#include <lefort/core/parallel.h>
#include <lefort/geometry/edge_incidence.h>
#include <lefort/geometry/smooth_surface.h>

#include <vector>

namespace lefort::geometry {
namespace {

/// If the mean of neighbors damps a wave by the fraction k (0 for the longest, at most 2), a pass
/// keeps 1 - kWeight^2 k^2 of its height: nothing grows, and long waves hardly shrink. In \cite
/// taubin1995 the outward step is slightly larger than the inward one, so that long waves grow.
constexpr double kWeight = 0.6;

/// The neighbors of each vertex, one list after the other; empty for vertices on boundary edges, so
/// that these do not move.
struct Neighbors {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> list;
};

Neighbors neighbors_of(const TriangleMesh& mesh) {
  const std::size_t count = mesh.vertices.size();
  const EdgeIncidence edges(mesh);
  std::vector<std::size_t> degree(count, 0);
  std::vector<char> is_open(count, 0);
  const auto for_each_edge = [&](const auto& body) {
    for (std::size_t v = 0; v < count; ++v)
      edges.for_each_edge_at(std::int32_t(v), [&](auto a, auto b, auto sides) {
        body(std::size_t(a), std::size_t(b), sides.size() == 1);
      });
  };
  for_each_edge([&](std::size_t a, std::size_t b, bool open) {
    ++degree[a];
    ++degree[b];
    if (open) is_open[a] = is_open[b] = 1;
  });
  Neighbors neighbors;
  neighbors.first.assign(count + 1, 0);
  for (std::size_t v = 0; v < count; ++v)
    neighbors.first[v + 1] = neighbors.first[v] + (is_open[v] != 0 ? 0 : degree[v]);
  neighbors.list.resize(neighbors.first.back());
  std::vector<std::size_t> next(neighbors.first.begin(), neighbors.first.end() - 1);
  for_each_edge([&](std::size_t a, std::size_t b, bool) {
    if (is_open[a] == 0) neighbors.list[next[a]++] = std::int32_t(b);
    if (is_open[b] == 0) neighbors.list[next[b]++] = std::int32_t(a);
  });
  return neighbors;
}

}  // namespace

TriangleMesh smooth_surface(TriangleMesh mesh, const SmoothOptions& options) {
  LEFORT_CHECK(options.passes >= 0 && options.max_mm > 0.0);
  if (options.passes == 0) return mesh;
  const Neighbors neighbors = neighbors_of(mesh);
  const std::vector<Vec3> start = mesh.vertices;
  std::vector<Vec3> moved = start;
  const auto step = [&](double weight) {
    parallel_for(mesh.vertex_count(), [&](Index i) {
      const auto v = std::size_t(i);
      const std::size_t from = neighbors.first[v], to = neighbors.first[v + 1];
      if (from == to) return;
      Vec3 mean = Vec3::Zero();
      for (std::size_t k = from; k < to; ++k) mean += mesh.vertices[std::size_t(neighbors.list[k])];
      mean /= double(to - from);
      moved[v] = mesh.vertices[v] + weight * (mean - mesh.vertices[v]);
    });
    mesh.vertices.swap(moved);
  };
  for (int pass = 0; pass < options.passes; ++pass) {
    step(kWeight);
    step(-kWeight);
  }
  parallel_for(mesh.vertex_count(), [&](Index i) {
    const auto v = std::size_t(i);
    const Vec3 shift = mesh.vertices[v] - start[v];
    const double length_mm = shift.norm();
    if (length_mm > options.max_mm)
      mesh.vertices[v] = start[v] + (options.max_mm / length_mm) * shift;
  });
  return mesh;
}

}  // namespace lefort::geometry
