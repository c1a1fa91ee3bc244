#include <lefort/geometry/mesh_edges.h>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace lefort::geometry {
namespace {

TEST(MeshEdges, ClosedSurfaceHasThreeHalvesAsManyEdgesAsTriangles) {
  const TriangleMesh torus = test::make_torus(5, 2, 12, 8);
  const MeshEdges edges = find_edges(torus);
  EXPECT_EQ(2 * edges.edge_count(), 3 * torus.triangle_count());
  for (Index e = 0; e < edges.edge_count(); ++e) {
    ASSERT_EQ(edges.uses_of(e).size(), 2U);
    EXPECT_NE(edges.uses_of(e)[0].forward, edges.uses_of(e)[1].forward);
    EXPECT_LT(edges.uses_of(e)[0].triangle, edges.uses_of(e)[1].triangle);
  }
}

TEST(MeshEdges, SidesAndUsesPointAtEachOther) {
  const TriangleMesh sheet = test::make_sheet(1, 3);
  const MeshEdges edges = find_edges(sheet);
  for (Index e = 0; e < edges.edge_count(); ++e) {
    for (const EdgeUse& use : edges.uses_of(e)) {
      const Triangle& t = sheet.triangles[std::size_t(use.triangle)];
      const auto side = std::size_t(use.side);
      const auto ends = std::minmax(t[side], t[(side + 1) % 3]);
      EXPECT_EQ(edges.ends[std::size_t(e)][0], ends.first);
      EXPECT_EQ(edges.ends[std::size_t(e)][1], ends.second);
      EXPECT_EQ(edges.of_triangle[std::size_t(use.triangle)][side], e);
    }
  }
  EXPECT_TRUE(std::is_sorted(edges.ends.begin(), edges.ends.end()));
}

TEST(MeshEdges, AnEdgeMayHaveAnyNumberOfTriangles) {
  TriangleMesh book;  // Three pages on the spine 0-1.
  book.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  book.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
  const MeshEdges edges = find_edges(book);
  EXPECT_EQ(edges.edge_count(), 7);
  EXPECT_EQ(edges.uses_of(0).size(), 3U);
}

}  // namespace
}  // namespace lefort::geometry
