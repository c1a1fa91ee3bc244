/// \file
/// The edges of a triangle soup, and which triangles meet there.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::geometry {

/// One side of a triangle lying on an edge.
struct EdgeUse {
  std::int32_t triangle;
  std::int8_t side;  ///< From corner `side` to corner (side + 1) % 3.
  bool forward;      ///< Runs from the smaller to the larger vertex number.
};

/// Edges in ascending order of (smaller, larger) vertex number; any number of uses each.
struct MeshEdges {
  std::vector<std::array<std::int32_t, 2>> ends;         ///< Smaller, larger vertex.
  std::vector<std::int32_t> first_use;                   ///< One per edge, and the total.
  std::vector<EdgeUse> uses;                             ///< By edge, then by triangle.
  std::vector<std::array<std::int32_t, 3>> of_triangle;  ///< Edge on each side.

  [[nodiscard]] Index edge_count() const { return Index(ends.size()); }
  [[nodiscard]] std::span<const EdgeUse> uses_of(Index edge) const {
    const auto first = std::size_t(first_use[std::size_t(edge)]);
    return std::span(uses).subspan(first, std::size_t(first_use[std::size_t(edge) + 1]) - first);
  }
};

/// \pre every vertex number of `mesh` is in range.
[[nodiscard]] MeshEdges find_edges(const TriangleMesh& mesh);

}  // namespace lefort::geometry
