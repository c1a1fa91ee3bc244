/// \file
/// The edges of a triangle soup and the triangles at each edge.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::geometry {

/// One edge of one triangle, from corner `side` to corner (side + 1) % 3.
struct HalfEdge {
  std::int32_t larger_end;  ///< The larger of its two vertex numbers.
  std::int32_t number;      ///< 3 * triangle + side.

  [[nodiscard]] Index triangle() const { return number / 3; }
  [[nodiscard]] int side() const { return number % 3; }
};

/// The half-edges of all triangles, grouped by edge. An edge may have any number of them.
class EdgeIncidence {
 public:
  /// \param mesh  any triangle soup. \pre its vertex numbers are valid.
  explicit EdgeIncidence(const TriangleMesh& mesh);

  /// Calls body(smaller_end, larger_end, half_edges) for each edge whose smaller vertex number is
  /// `vertex`, by ascending larger end; half-edges by ascending triangle.
  ///
  /// \param vertex  the smaller vertex number of the edges.
  /// \param body    called once per edge.
  template <class Body>
  void for_each_edge_at(std::int32_t vertex, const Body& body) const {
    const std::size_t end = first_[std::size_t(vertex) + 1];
    for (std::size_t from = first_[std::size_t(vertex)], to = from; from < end; from = to) {
      while (to < end && half_edges_[to].larger_end == half_edges_[from].larger_end) ++to;
      body(vertex, half_edges_[from].larger_end, std::span(half_edges_).subspan(from, to - from));
    }
  }

  [[nodiscard]] Index vertex_count() const { return Index(first_.size()) - 1; }

 private:
  std::vector<std::uint32_t> first_;  ///< By smaller end.
  std::vector<HalfEdge> half_edges_;
};

/// True if the half-edge runs from its smaller to its larger vertex number.
[[nodiscard]] inline bool is_canonical_direction(const TriangleMesh& mesh, const HalfEdge& side) {
  const Triangle& t = mesh.triangles[std::size_t(side.triangle())];
  return t[std::size_t(side.side())] <= t[std::size_t((side.side() + 1) % 3)];
}

}  // namespace lefort::geometry
