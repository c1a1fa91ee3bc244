#include <lefort/image/interpolate.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lefort::image::test_interpolate {
namespace {

constexpr double kOutside = -4321.0;

Grid oblique_grid() {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  return {.size = {4, 5, 7},
          .spacing_mm = {0.4, 0.5, 1.25},
          .origin_L = {-80, 3, 9},
          .direction = turn};
}

template <class T, class Function>
Volume<T> sampled(const Grid& grid, const Function& f_L) {
  Volume<T> volume{grid, std::vector<T>(static_cast<std::size_t>(grid.voxel_count()))};
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        volume.at(i, j, k) = static_cast<T>(f_L(grid.point_L(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
  return volume;
}

/// Points between the outermost voxel centers.
std::vector<Vec3> points_within(const Grid& grid, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> fraction(0.0, 1.0);
  std::vector<Vec3> points_L;
  for (int n = 0; n < count; ++n) {
    Vec3 p_V;
    for (int a = 0; a < 3; ++a)
      p_V[a] = fraction(random) * static_cast<double>(grid.size[static_cast<std::size_t>(a)] - 1);
    points_L.push_back(grid.point_L(p_V));
  }
  return points_L;
}

TEST(Interpolate, IsExactForALinearFunctionOnAnObliqueGrid) {
  const Vec3 slope(3.0, -2.0, 0.5);
  const auto linear = [&](const Vec3& p_L) { return slope.dot(p_L) + 17.0; };
  const auto volume = sampled<double>(oblique_grid(), linear);
  for (const Vec3& p_L : points_within(volume.grid, 500))
    EXPECT_NEAR(interpolate(volume, p_L, kOutside), linear(p_L), 1e-9);
}

TEST(Interpolate, GivesTheVoxelAtItsCenter) {
  const Grid grid = oblique_grid();
  const auto volume = sampled<std::int16_t>(grid, [](const Vec3& p_L) { return 100.0 * p_L.x(); });
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const Vec3 center_V(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
        EXPECT_NEAR(interpolate(volume, grid.point_L(center_V), kOutside), volume.at(i, j, k),
                    1e-9);
      }
}

TEST(Interpolate, ABorderVoxelReachesHalfASpacingFurtherAndNoMore) {
  const auto volume = sampled<float>(oblique_grid(), [](const Vec3& p_L) { return p_L.norm(); });
  const Grid& grid = volume.grid;
  for (int a = 0; a < 3; ++a) {
    const double last = static_cast<double>(grid.size[static_cast<std::size_t>(a)] - 1);
    for (const double side : {-1.0, 1.0}) {
      Vec3 border_V(1.0, 2.0, 3.0);
      border_V[a] = side < 0.0 ? 0.0 : last;
      const double value = interpolate(volume, grid.point_L(border_V), kOutside);
      const auto beyond = [&](double fraction) -> Vec3 {
        return grid.point_L(border_V + fraction * side * Vec3::Unit(a));
      };
      EXPECT_NEAR(interpolate(volume, beyond(0.499), kOutside), value, 1e-6);
      EXPECT_EQ(interpolate(volume, beyond(0.501), kOutside), kOutside);
    }
  }
}

TEST(Interpolate, HasNoValueAtPointsThatAreNotFiniteOrFarAway) {
  const auto volume = sampled<float>(oblique_grid(), [](const Vec3&) { return 1.0; });
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(interpolate(volume, Vec3(nan, 0.0, 0.0), kOutside), kOutside);
  EXPECT_EQ(interpolate(volume, Vec3(1e300, 0.0, 0.0), kOutside), kOutside);
}

TEST(Interpolate, AcceptsASingleVoxelAndAnEmptyVolume) {
  const Volume<std::uint8_t> one{{.size = {1, 1, 1}}, {200}};
  EXPECT_EQ(interpolate(one, Vec3(0.4, -0.4, 0.3), kOutside), 200.0);
  const Volume<std::uint8_t> none;
  for (const double x : {0.0, -0.5, -1.0})
    EXPECT_EQ(interpolate(none, Vec3(x, x, x), kOutside), kOutside);
}

}  // namespace
}  // namespace lefort::image::test_interpolate
