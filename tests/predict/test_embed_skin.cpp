#include <lefort/predict/embed_skin.h>

#include <gtest/gtest.h>

#include <cmath>

#include "support/box_mesh.h"
#include "support/shapes.h"

namespace lefort::predict::test_embed_skin {
namespace {

const mesh::VolumeMesh& tissue() {
  static const mesh::VolumeMesh block =
      test::box_mesh({.cells = {5, 5, 5}, .size_mm = {10.0, 10.0, 10.0}});
  return block;
}

std::vector<Vec3> displace_by(const Mat3& gradient) {
  std::vector<Vec3> u;
  for (const Vec3& X : tissue().nodes_L) u.push_back(gradient * X);
  return u;
}

TEST(EmbedSkin, FollowsALinearDisplacementExactlyOnTheMesh) {
  const Mat3 gradient = (Mat3() << 0.1, 0.2, 0.0, -0.1, 0.05, 0.3, 0.0, 0.1, -0.2).finished();
  geometry::TriangleMesh skin;  // Points on the sides of the block that are not nodes.
  skin.vertices = {{0.0, 3.3, 4.7}, {10.0, 0.9, 9.1}, {2.2, 10.0, 5.6}};
  skin.triangles = {{0, 1, 2}};
  const auto u = skin_displacement(embed_skin(skin, tissue(), 2.0), displace_by(gradient));
  for (std::size_t v = 0; v < 3; ++v) EXPECT_LT((u[v] - gradient * skin.vertices[v]).norm(), 1e-12);
}

TEST(EmbedSkin, DecreasesToZeroAwayFromTheMesh) {
  geometry::TriangleMesh skin;
  for (double x = 10.0; x <= 20.0; x += 0.25) skin.vertices.emplace_back(x, 5.0, 5.0);
  skin.triangles = {{0, 1, 2}};
  const std::vector<Vec3> forward(tissue().nodes_L.size(), Vec3(0.0, -6.0, 0.0));
  const auto u = skin_displacement(embed_skin(skin, tissue(), 2.0), forward);
  EXPECT_NEAR(u.front().y(), -6.0, 1e-12);
  EXPECT_EQ(u.back(), Vec3::Zero());
  for (std::size_t v = 1; v < u.size(); ++v) {
    EXPECT_GE(u[v].y(), u[v - 1].y() - 1e-12);          // Never grows again,
    EXPECT_LT(std::abs(u[v].y() - u[v - 1].y()), 0.6);  // and never jumps.
  }
}

TEST(EmbedSkin, EmbeddingDistanceGrowsWithElementsAndVoxels) {
  const double fine_mm = embedding_distance_mm({.element_size_mm = 2.5}, {1.0, 1.0, 1.5});
  EXPECT_GT(fine_mm, 0.15 * 2.5 + 0.5 * 1.5);
  EXPECT_GT(embedding_distance_mm({.element_size_mm = 5.0}, {1.0, 1.0, 1.5}), fine_mm);
  EXPECT_GT(embedding_distance_mm({.element_size_mm = 2.5}, {1.0, 1.0, 3.0}), fine_mm);
}

TEST(EmbedSkin, DisplacedMovesEveryVertexAndKeepsTheTriangles) {
  const geometry::TriangleMesh box = test::make_box(Vec3::Zero(), Vec3::Ones());
  const std::vector<Vec3> shift(box.vertices.size(), Vec3(1.0, 2.0, 3.0));
  const geometry::TriangleMesh moved = displaced(box, shift);
  EXPECT_EQ(moved.triangles, box.triangles);
  EXPECT_EQ(moved.vertices[5], box.vertices[5] + Vec3(1.0, 2.0, 3.0));
}

}  // namespace
}  // namespace lefort::predict::test_embed_skin
