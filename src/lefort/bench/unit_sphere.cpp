#include <lefort/bench/unit_sphere.h>

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace lefort::bench {

void halve_edges(geometry::TriangleMesh& ball) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle = [&](std::int32_t a, std::int32_t b) {
    const auto [known, is_new] =
        middles.try_emplace(std::minmax(a, b), std::int32_t(ball.vertices.size()));
    if (is_new)
      ball.vertices.push_back(
          (ball.vertices[std::size_t(a)] + ball.vertices[std::size_t(b)]).normalized());
    return known->second;
  };
  std::vector<geometry::Triangle> finer;
  for (const auto& [a, b, c] : std::exchange(ball.triangles, {})) {
    const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  ball.triangles = std::move(finer);
}

}  // namespace lefort::bench
