#include <lefort/geometry/edge_incidence.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "support/shapes.h"

namespace lefort::geometry::test_edge_incidence {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;

/// Number of half-edges at each edge; checks that each half-edge belongs to its edge.
std::map<Edge, std::size_t> count_sides(const TriangleMesh& mesh) {
  const EdgeIncidence sides(mesh);
  std::map<Edge, std::size_t> counts;
  std::set<std::int32_t> seen;
  EXPECT_EQ(sides.vertex_count(), mesh.vertex_count());
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    std::int32_t last = -1;
    sides.for_each_edge_at(v, [&](std::int32_t smaller, std::int32_t larger, auto there) {
      EXPECT_EQ(smaller, v);
      EXPECT_LT(last, larger);
      last = larger;
      counts[{smaller, larger}] = there.size();
      for (const HalfEdge& s : there) {
        EXPECT_TRUE(seen.insert(s.number).second);
        const Triangle& t = mesh.triangles[std::size_t(s.triangle())];
        const auto ends = std::minmax(t[std::size_t(s.side())], t[std::size_t((s.side() + 1) % 3)]);
        EXPECT_EQ(Edge(ends), Edge(smaller, larger));
      }
      EXPECT_TRUE(std::is_sorted(there.begin(), there.end(), [](const auto& x, const auto& y) {
        return x.triangle() < y.triangle();
      }));
    });
  }
  EXPECT_EQ(seen.size(), 3 * mesh.triangles.size());
  return counts;
}

TEST(EdgeIncidence, EveryEdgeOfAClosedSurfaceHasTwoOppositeHalfEdges) {
  const TriangleMesh torus = test::make_torus(5, 2, 12, 8);
  const auto counts = count_sides(torus);
  EXPECT_EQ(2 * counts.size(), 3 * torus.triangles.size());
  const EdgeIncidence sides(torus);
  for (std::int32_t v = 0; v < torus.vertex_count(); ++v)
    sides.for_each_edge_at(v, [&](std::int32_t, std::int32_t, auto there) {
      ASSERT_EQ(there.size(), 2U);
      EXPECT_NE(is_canonical_direction(torus, there[0]), is_canonical_direction(torus, there[1]));
    });
}

TEST(EdgeIncidence, BoundaryEdgesHaveOneHalfEdge) {
  const TriangleMesh sheet = test::make_sheet(1, 3);
  const auto counts = count_sides(sheet);
  const auto rim =
      std::count_if(counts.begin(), counts.end(), [](const auto& c) { return c.second == 1; });
  EXPECT_GT(rim, 0);
  EXPECT_EQ(3 * sheet.triangles.size(), 2 * counts.size() - std::size_t(rim));
}

TEST(EdgeIncidence, AnEdgeMayHaveAnyNumberOfHalfEdges) {
  TriangleMesh book;  // Three triangles at the edge 0-1.
  book.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  book.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
  const auto counts = count_sides(book);
  EXPECT_EQ(counts.size(), 7U);
  EXPECT_EQ(counts.at({0, 1}), 3U);
}

}  // namespace
}  // namespace lefort::geometry::test_edge_incidence
