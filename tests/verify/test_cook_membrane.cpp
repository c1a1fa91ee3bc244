#include <lefort/verify/cook_membrane.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lefort::verify::test_cook_membrane {
namespace {

using mesh::ElementShape;

// The rise of the tip with each shape, with and without the remedy, is the case "cook" of
// test_suite.cpp.

TEST(CookMembrane, HasALoadOfAHundredNewtonsPerMillimeterOfThickness) {
  const CookMembrane membrane = make_cook_membrane(ElementShape::kTet10, 4);
  Vec3 sum = Vec3::Zero();
  for (const fem::NodalForce& force : membrane.forces) sum += force.force_n;
  EXPECT_LT((sum - Vec3(0, 100.0 * 12.0, 0)).norm(), 1e-10);
  const Vec3& tip = membrane.mesh.nodes_L[std::size_t(membrane.tip)];
  EXPECT_EQ(tip.head<2>(), Eigen::Vector2d(48, 60));
}

TEST(CookMembrane, IsTheSamePlateDividedAlongEitherDiagonal) {
  double side_mm[2];
  for (const Diagonal diagonal : {Diagonal::kShorter, Diagonal::kLonger}) {
    const CookMembrane membrane = make_cook_membrane(ElementShape::kWedge6, 1, diagonal);
    const Vec3& tip = membrane.mesh.nodes_L[std::size_t(membrane.tip)];
    EXPECT_EQ(tip.head<2>(), Eigen::Vector2d(48, 60));
    EXPECT_EQ(membrane.mesh.node_count(), 8);
    // The diagonal is the pair of corners on z = 0 that belong to both triangles there.
    const mesh::ElementBlock& wedges = membrane.mesh.blocks.front();
    std::vector<Vec3> shared;
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < 6; ++b) {
        const Vec3& p = membrane.mesh.nodes_L[std::size_t(wedges.element(0)[a])];
        if (wedges.element(0)[a] == wedges.element(1)[b] && p.z() == 0.0) shared.push_back(p);
      }
    ASSERT_EQ(shared.size(), 2U);
    side_mm[diagonal == Diagonal::kLonger] = (shared[1] - shared[0]).norm();
  }
  EXPECT_NEAR(side_mm[0], 48.0, 1e-12);                // From (0, 44) to (48, 44).
  EXPECT_NEAR(side_mm[1], std::hypot(48, 60), 1e-12);  // From (0, 0) to (48, 60).
}

}  // namespace
}  // namespace lefort::verify::test_cook_membrane
