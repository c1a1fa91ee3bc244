#include <lefort/geometry/fit_rigid.h>
#include <lefort/geometry/rigid_motion.h>

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>
#include <vector>

namespace lefort::geometry::test_fit_rigid {
namespace {

std::vector<Vec3> some_points(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(-40.0, 40.0);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.emplace_back(at(random), at(random), at(random));
  return points;
}

std::vector<Vec3> moved(const std::vector<Vec3>& points, const RigidTransform& X) {
  std::vector<Vec3> result;
  for (const Vec3& p : points) result.push_back(X * p);
  return result;
}

TEST(FitRigid, RecoversAKnownMotion) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto from = some_points(3 + int(seed % 4), seed);
    const RigidTransform X =
        rigid_motion({3, -7, 2}, {0.1 * seed, -0.07 * seed, 0.03 * seed}, {10, 20, 30});
    const auto fit = fit_rigid(from, moved(from, X));
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_LT((fit->X_to_from.matrix() - X.matrix()).norm(), 1e-10) << "seed " << seed;
    EXPECT_LT(fit->max_residual_mm, 1e-10);
  }
}

TEST(FitRigid, AMirrorImageIsFittedByARotation) {
  const auto from = some_points(6, 3);
  std::vector<Vec3> mirrored = from;
  for (Vec3& p : mirrored) p.x() = -p.x();
  const auto fit = fit_rigid(from, mirrored).value();
  EXPECT_NEAR(fit.X_to_from.linear().determinant(), 1.0, 1e-12);
  EXPECT_GT(fit.rms_mm, 1.0);
}

TEST(FitRigid, NoNearbyMotionIsBetter) {
  const auto from = some_points(5, 7);
  auto to = moved(from, rigid_motion({1, 2, 3}, {0.3, 0.2, -0.4}, {0, 0, 0}));
  to[2] += Vec3(4, 0, 0);
  const auto fit = fit_rigid(from, to).value();
  EXPECT_EQ(fit.max_residual_index, 2);
  const auto sum_of_squares = [&](const RigidTransform& X) {
    double sum = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) sum += (X * from[i] - to[i]).squaredNorm();
    return sum;
  };
  EXPECT_NEAR(sum_of_squares(fit.X_to_from), 5.0 * fit.rms_mm * fit.rms_mm, 1e-9);
  for (int axis = 0; axis < 3; ++axis)
    for (const double step : {-1e-3, 1e-3}) {
      const Vec3 along = step * Vec3::Unit(axis);
      EXPECT_GT(sum_of_squares(rigid_motion(along, Vec3::Zero(), {0, 0, 0}) * fit.X_to_from),
                sum_of_squares(fit.X_to_from));
      EXPECT_GT(sum_of_squares(rigid_motion(Vec3::Zero(), along, {0, 0, 0}) * fit.X_to_from),
                sum_of_squares(fit.X_to_from));
    }
}

TEST(FitRigid, RejectsPointsThatDoNotDetermineTheMotion) {
  const auto refuse = [](const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                         const char* words) {
    const auto fit = fit_rigid(from, to);
    ASSERT_FALSE(fit) << words;
    EXPECT_EQ(fit.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(fit.error().message.find(words), std::string::npos) << fit.error().message;
  };
  const auto points = some_points(4, 1);
  const std::vector<Vec3> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
  refuse({points[0], points[1]}, {points[0], points[1]}, "2 points");
  refuse(points, {points[0], points[1], points[2]}, "4 points for 3 targets");
  refuse(line, points, "the points are collinear");
  refuse(points, line, "the targets are collinear");
  auto broken = points;
  broken[3].y() = std::numeric_limits<double>::quiet_NaN();
  refuse(points, broken, "point 3");
}

}  // namespace
}  // namespace lefort::geometry::test_fit_rigid
