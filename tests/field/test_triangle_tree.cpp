#include <lefort/field/build/triangle_tree.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "field/brute_force.h"
#include "support/shapes.h"
#include "support/ugly_mesh.h"

namespace lefort::field::test_triangle_tree {
namespace {

/// Checks the part of the tree below a node and adds its triangles.
///
/// \returns the position after it.
std::int32_t check_below(const geometry::TriangleMesh& mesh, const TriangleTree& tree,
                         std::int32_t n, std::vector<std::int32_t>& triangles) {
  const TriangleTree::Node& node = tree.nodes.at(std::size_t(n));
  const std::size_t before = triangles.size();
  std::int32_t next = n + 1;
  if (node.count > 0) {
    EXPECT_LE(node.count, TriangleTree::kLeafTriangles);
    for (std::int32_t i = node.first; i < node.first + node.count; ++i)
      triangles.push_back(tree.order.at(std::size_t(i)));
  } else {
    next = check_below(mesh, tree, next, triangles);
    EXPECT_EQ(next, node.first);
    next = check_below(mesh, tree, next, triangles);
  }
  for (std::size_t i = before; i < triangles.size(); ++i)
    for (int corner = 0; corner < 3; ++corner)
      for (int k = 0; k < 3; ++k) {
        const double x = mesh.corner(triangles[i], corner)[k] - tree.origin[k];
        EXPECT_LE(double(node.low[std::size_t(k)]), x);
        EXPECT_GE(double(node.high[std::size_t(k)]), x);
      }
  return next;
}

TEST(TriangleTree, ContainsEveryTriangleOnceInsideItsBoxes) {
  std::mt19937 random(3);
  for (int round = 0; round < 40; ++round) {
    const geometry::TriangleMesh mesh =
        round == 0 ? test::make_torus(8, 3, 24, 12) : test::make_soup(random);
    const Vec3 origin(-12.3, 7.1, 100.0 / 3.0);
    const TriangleTree tree = build_triangle_tree(mesh, origin);
    std::vector<std::int32_t> triangles;
    EXPECT_EQ(check_below(mesh, tree, 0, triangles), std::int32_t(tree.nodes.size()));
    std::sort(triangles.begin(), triangles.end());
    ASSERT_EQ(Index(triangles.size()), mesh.triangle_count());
    for (Index t = 0; t < mesh.triangle_count(); ++t)
      EXPECT_EQ(triangles[std::size_t(t)], std::int32_t(t));
  }
}

TEST(TriangleTree, GivesTheDistanceOfTheNearestTriangle) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> in(-3, 3);
  for (int round = 0; round < 30; ++round) {
    const geometry::TriangleMesh mesh = test::make_soup(random);
    const TriangleTree tree = build_triangle_tree(mesh, Vec3(1, 2, 3));
    for (int n = 0; n < 20; ++n) {
      const Vec3 p(in(random), in(random), in(random));
      const double truth = test::brute_distance(mesh, p);
      EXPECT_NEAR(std::sqrt(squared_distance(mesh, tree, p, truth * 1.001)), truth, 1e-12);
      EXPECT_TRUE(std::isinf(squared_distance(mesh, tree, p, truth * 0.999)));
    }
  }
}

}  // namespace
}  // namespace lefort::field::test_triangle_tree
