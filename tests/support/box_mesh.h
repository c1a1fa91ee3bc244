/// \file
/// Boxes of tetrahedra for tests: structured, distorted at will, with named sides.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace lefort::test {

struct BoxMeshOptions {
  std::array<int, 3> cells{2, 2, 2};  ///< Cubes along x, y, z; six tetrahedra each.
  Vec3 size_mm = Vec3::Ones();        ///< The box reaches from the origin to here.
  double distortion = 0.0;            ///< Inner nodes move by up to this share of a cell, < 0.2.
  unsigned seed = 7;                  ///< Of the distortion.
  mesh::ElementShape shape = mesh::ElementShape::kTet4;  ///< Or kTet10, edges straight.
};

namespace internal {

/// Turns tet4 into tet10 by putting a node in the middle of every edge.
inline void add_middle_nodes(mesh::VolumeMesh& mesh) {
  constexpr std::array<std::array<int, 2>, 6> kEdges{
      {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle;
  const mesh::ElementBlock corners = std::exchange(mesh.blocks[0], {});
  mesh::ElementBlock& block = mesh.blocks[0];
  block.shape = mesh::ElementShape::kTet10;
  block.region = corners.region;
  for (Index e = 0; e < corners.element_count(); ++e) {
    const std::int32_t* node = corners.element(e);
    block.nodes.insert(block.nodes.end(), node, node + 4);
    for (const auto& [i, j] : kEdges) {
      const auto [known, is_new] =
          middle.try_emplace(std::minmax(node[i], node[j]), std::int32_t(mesh.nodes_L.size()));
      if (is_new)
        mesh.nodes_L.emplace_back(
            0.5 * (mesh.nodes_L[std::size_t(node[i])] + mesh.nodes_L[std::size_t(node[j])]));
      block.nodes.push_back(known->second);
    }
  }
}

}  // namespace internal

/// A box of region 0 with the node sets x0, x1, y0, y1, z0, z1 (its sides) and "outside".
inline mesh::VolumeMesh box_mesh(const BoxMeshOptions& options = {}) {
  const auto [nx, ny, nz] = options.cells;
  const Vec3 cell_mm = options.size_mm.cwiseQuotient(Vec3(nx, ny, nz));
  const auto number = [nx = nx, ny = ny](int i, int j, int k) {
    return std::int32_t(i + (nx + 1) * (j + (ny + 1) * k));
  };

  mesh::VolumeMesh mesh;
  std::mt19937 generator(options.seed);
  const auto shift = [&] { return 2.0 * double(generator()) / 4294967295.0 - 1.0; };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        Vec3 p = Vec3(i, j, k);
        if (i % nx != 0 && j % ny != 0 && k % nz != 0)
          p += options.distortion * Vec3(shift(), shift(), shift());
        mesh.nodes_L.emplace_back(p.cwiseProduct(cell_mm));
      }

  // Kuhn's split: one tetrahedron per order in which the three axes are walked.
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  mesh::ElementBlock& block = mesh.blocks.emplace_back();
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (std::size_t o = 0; o < kOrders.size(); ++o) {
          std::array<int, 3> at{i, j, k};
          std::array<std::int32_t, 4> tet{number(i, j, k)};
          for (std::size_t s = 0; s < 3; ++s) {
            ++at[std::size_t(kOrders[o][s])];
            tet[s + 1] = number(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(tet[2], tet[3]);  // Odd orders turn the other way.
          block.nodes.insert(block.nodes.end(), tet.begin(), tet.end());
          block.region.push_back(0);
        }

  if (options.shape == mesh::ElementShape::kTet10) internal::add_middle_nodes(mesh);
  for (std::size_t n = 0; n < mesh.nodes_L.size(); ++n) {
    const Vec3& p = mesh.nodes_L[n];
    bool outside = false;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        if (std::abs(p[axis] - side * options.size_mm[axis]) > 1e-9 * cell_mm[axis]) continue;
        outside = true;
        mesh.node_sets[{"xyz"[axis], "01"[side]}].push_back(std::int32_t(n));
      }
    if (outside) mesh.node_sets["outside"].push_back(std::int32_t(n));
  }
  return mesh;
}

}  // namespace lefort::test
