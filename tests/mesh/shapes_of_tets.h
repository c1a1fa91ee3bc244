/// \file
/// Small meshes of tetrahedra with known measures.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <cmath>
#include <vector>

namespace lefort::test {

[[nodiscard]] inline mesh::VolumeMesh tets(std::vector<Vec3> nodes,
                                           std::vector<std::int32_t> elements) {
  mesh::VolumeMesh mesh;
  mesh.nodes_L = std::move(nodes);
  mesh::ElementBlock& block = mesh.blocks.emplace_back();
  block.region.assign(elements.size() / 4, 0);
  block.nodes = std::move(elements);
  return mesh;
}

/// Edge length 1.
[[nodiscard]] inline mesh::VolumeMesh regular_tet() {
  const double h = std::sqrt(3.0) / 2.0;
  return tets({{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}, {0.5, h / 3.0, std::sqrt(2.0 / 3.0)}},
              {0, 1, 2, 3});
}

/// A box of n^3 cubes with side 1, six tetrahedra each around the cube's diagonal.
[[nodiscard]] inline mesh::VolumeMesh cube_of_tets(int n) {
  std::vector<Vec3> nodes;
  std::vector<std::int32_t> elements;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) nodes.emplace_back(i, j, k);
  const auto at = [n](int i, int j, int k) {
    return std::int32_t(i + (n + 1) * (j + (n + 1) * k));
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const std::int32_t a = at(i, j, k), g = at(i + 1, j + 1, k + 1);
        const std::int32_t ring[]{at(i + 1, j, k),     at(i + 1, j + 1, k), at(i, j + 1, k),
                                  at(i, j + 1, k + 1), at(i, j, k + 1),     at(i + 1, j, k + 1)};
        for (int r = 0; r < 6; ++r)
          elements.insert(elements.end(), {a, ring[r], ring[(r + 1) % 6], g});
      }
  return tets(std::move(nodes), std::move(elements));
}

}  // namespace lefort::test
