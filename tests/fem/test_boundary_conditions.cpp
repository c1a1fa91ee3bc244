#include <lefort/fem/assembly/boundary_conditions.h>

#include <gtest/gtest.h>

#include <numbers>

namespace lefort::fem::test_boundary_conditions {
namespace {

TEST(BoundaryConditions, PrescribeZeroPrescribesAllThreeComponents) {
  const std::vector<std::int32_t> nodes{4, 9};
  const auto prescribed = prescribe_zero(nodes);
  ASSERT_EQ(prescribed.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(prescribed[k].node, nodes[k / 3]);
    EXPECT_EQ(prescribed[k].component, int(k % 3));
    EXPECT_EQ(prescribed[k].displacement_mm, 0.0);
  }
}

TEST(BoundaryConditions, PrescribeRigidMotionMovesNodesWithTheBody) {
  const std::vector<Vec3> nodes_L{{9, 9, 9}, {1, 0, 0}};
  RigidTransform motion_LL = RigidTransform::Identity();
  motion_LL.translate(Vec3(0, 0, 5)).rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()));
  const auto prescribed = prescribe_rigid_motion(std::vector<std::int32_t>{1}, nodes_L, motion_LL);
  ASSERT_EQ(prescribed.size(), 3U);
  const Vec3 expected(-1, 1, 5);  // (1,0,0) goes to (0,1,5).
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(prescribed[c].node, 1);
    EXPECT_NEAR(prescribed[c].displacement_mm, expected[Index(c)], 1e-15);
  }
}

}  // namespace
}  // namespace lefort::fem::test_boundary_conditions
