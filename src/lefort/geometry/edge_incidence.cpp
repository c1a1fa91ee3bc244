#include <lefort/core/parallel.h>
#include <lefort/geometry/edge_incidence.h>

#include <algorithm>

namespace lefort::geometry {

EdgeIncidence::EdgeIncidence(const TriangleMesh& mesh) {
  const auto ends_of = [](const Triangle& t, std::size_t side) {
    return std::minmax(t[side], t[(side + 1) % 3]);
  };
  first_.assign(mesh.vertices.size() + 1, 0);
  for (const Triangle& t : mesh.triangles)
    for (std::size_t side = 0; side < 3; ++side) ++first_[std::size_t(ends_of(t, side).first) + 1];
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) first_[v + 1] += first_[v];

  half_edges_.resize(3 * mesh.triangles.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  std::int32_t number = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t side = 0; side < 3; ++side) {
      const auto [smaller, larger] = ends_of(t, side);
      half_edges_[next[std::size_t(smaller)]++] = {larger, number++};
    }
  parallel_for(
      mesh.vertex_count(),
      [&](Index v) {
        std::sort(half_edges_.begin() + first_[std::size_t(v)],
                  half_edges_.begin() + first_[std::size_t(v) + 1],
                  [](const HalfEdge& x, const HalfEdge& y) {
                    return x.larger_end != y.larger_end ? x.larger_end < y.larger_end
                                                        : x.number < y.number;
                  });
      },
      4096);
}

}  // namespace lefort::geometry
