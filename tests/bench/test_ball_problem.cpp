#include <lefort/bench/ball_problem.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace lefort::bench::test_ball_problem {
namespace {

TEST(BallProblem, TheBallTouchesTheUpperSideAtFirst) {
  const geometry::TriangleMesh ball = BallProblem::ball(3);
  double lowest_mm = 1e9;
  for (const Vec3& v : ball.vertices) {
    EXPECT_NEAR((v - BallProblem::center_mm()).norm(), BallProblem::kRadius_mm, 1e-12);
    lowest_mm = std::min(lowest_mm, v.z());
  }
  double highest_mm = -1e9;
  for (const Vec3& x : BallProblem::block().nodes_L) highest_mm = std::max(highest_mm, x.z());
  EXPECT_NEAR(highest_mm, 20.0, 1e-12);
  EXPECT_GE(lowest_mm, highest_mm);
  EXPECT_LT(lowest_mm, highest_mm + 0.2);  // The lowest point of the sphere is no vertex.
  EXPECT_EQ(ball.triangles.size(), 20U * 64U);
}

TEST(BallProblem, ThePathIsPressedThenSlid) {
  const geometry::RigidPath path = BallProblem::path();
  const double pressed = 10.0 / 26.0;
  EXPECT_TRUE(geometry::pose_at(path, pressed).translation().isApprox(Vec3(0, 0, -5)));
  EXPECT_TRUE(geometry::pose_at(path, 1.0).translation().isApprox(Vec3(16, 0, -5)));
}

}  // namespace
}  // namespace lefort::bench::test_ball_problem
