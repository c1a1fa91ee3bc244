#include <lefort/image/flip_axis.h>
#include <lefort/image/interpolate.h>

#include <gtest/gtest.h>

#include <numeric>

namespace lefort::image::test_flip_axis {
namespace {

Volume<int> numbered_volume() {
  const Mat3 turn = Eigen::AngleAxisd(0.4, Vec3(1.0, -1.0, 2.0).normalized()).toRotationMatrix();
  Volume<int> volume{
      {.size = {2, 3, 5}, .spacing_mm = {0.5, 0.7, 2.0}, .origin_L = {4, 5, 6}, .direction = turn},
      std::vector<int>(30)};
  std::iota(volume.values.begin(), volume.values.end(), 0);
  return volume;
}

TEST(FlipAxis, KeepsEveryValueAtItsPointAndChangesHandedness) {
  const Volume<int> before = numbered_volume();
  for (int axis = 0; axis < 3; ++axis) {
    Volume<int> after = before;
    flip_axis(after, axis);
    EXPECT_NEAR(after.grid.direction.determinant(), -1.0, 1e-12);
    EXPECT_NE(after.values, before.values);
    for (Index k = 0; k < 5; ++k)
      for (Index j = 0; j < 3; ++j)
        for (Index i = 0; i < 2; ++i) {
          const Vec3 p_L = before.grid.point_L(
              {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          EXPECT_NEAR(interpolate(after, p_L, -1.0), before.at(i, j, k), 1e-9);
        }
  }
}

TEST(FlipAxis, TwiceIsTheIdentity) {
  for (int axis = 0; axis < 3; ++axis) {
    Volume<int> volume = numbered_volume();
    flip_axis(volume, axis);
    flip_axis(volume, axis);
    EXPECT_EQ(volume.values, numbered_volume().values);
    EXPECT_TRUE(volume.grid.origin_L.isApprox(numbered_volume().grid.origin_L, 1e-12));
    EXPECT_EQ(volume.grid.direction, numbered_volume().grid.direction);
  }
}

TEST(FlipAxis, LeavesNoNegativeZero) {
  Volume<int> volume = numbered_volume();
  volume.grid.direction = Mat3::Identity();
  flip_axis(volume, 2);
  for (const double x : volume.grid.direction.reshaped()) EXPECT_TRUE(x != 0.0 || !std::signbit(x));
}

}  // namespace
}  // namespace lefort::image::test_flip_axis
