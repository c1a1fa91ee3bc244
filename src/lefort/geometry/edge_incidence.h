/// \file
/// The edges of a triangle soup, and which triangles meet there.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::geometry {

/// Side `side` of a triangle, from corner `side` to corner (side + 1) % 3, as 3 * triangle + side.
struct HalfEdge {
  std::int32_t larger_end;  ///< The larger of its two vertex numbers.
  std::int32_t number;

  [[nodiscard]] Index triangle() const { return number / 3; }
  [[nodiscard]] int side() const { return number % 3; }
};

/// The sides of all triangles, grouped by the edge they lie on; any number of them each.
class EdgeIncidence {
 public:
  /// \pre every vertex number of `mesh` is in range.
  explicit EdgeIncidence(const TriangleMesh& mesh);

  /// Calls body(smaller_end, larger_end, sides) for each edge whose smaller vertex number is
  /// `vertex`, by ascending larger end; sides by ascending triangle.
  template <class Body>
  void for_each_edge_at(std::int32_t vertex, const Body& body) const {
    const std::size_t end = first_[std::size_t(vertex) + 1];
    for (std::size_t from = first_[std::size_t(vertex)], to = from; from < end; from = to) {
      while (to < end && sides_[to].larger_end == sides_[from].larger_end) ++to;
      body(vertex, sides_[from].larger_end, std::span(sides_).subspan(from, to - from));
    }
  }

  [[nodiscard]] Index vertex_count() const { return Index(first_.size()) - 1; }

 private:
  std::vector<std::uint32_t> first_;  ///< By smaller end.
  std::vector<HalfEdge> sides_;
};

/// True if the side runs from its smaller to its larger vertex number.
[[nodiscard]] inline bool is_canonical_direction(const TriangleMesh& mesh, const HalfEdge& side) {
  const Triangle& t = mesh.triangles[std::size_t(side.triangle())];
  return t[std::size_t(side.side())] <= t[std::size_t((side.side() + 1) % 3)];
}

}  // namespace lefort::geometry
