#include <lefort/anatomy/minimal_path.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace lefort::anatomy {
namespace {

image::Grid grid_of_size(Index n, const Vec3& spacing_mm) {
  image::Grid grid;
  grid.size = {n, n, n};
  grid.spacing_mm = spacing_mm;
  return grid;
}

image::ScalarVolume uniform(const image::Grid& grid, float speed) {
  return {grid, std::vector<float>(std::size_t(grid.voxel_count()), speed)};
}

TEST(MinimalPath, arrival_times_are_distances_over_speed) {
  const image::Grid grid = grid_of_size(41, {1.0, 0.8, 1.3});
  const FrontSource source{grid.offset(20, 20, 20)};
  const image::ScalarVolume times = arrival_times(uniform(grid, 2.0F), {&source, 1});
  const Vec3 center = grid.point_L({20, 20, 20});
  for (const auto& [i, j, k] :
       {std::array<Index, 3>{40, 20, 20}, {20, 0, 20}, {38, 3, 30}, {5, 36, 8}, {20, 33, 31}}) {
    const double distance_mm = (grid.point_L({double(i), double(j), double(k)}) - center).norm();
    const double expected = distance_mm / 2.0;
    EXPECT_GE(double(times.at(i, j, k)), 0.999 * expected);  // First order: never early ...
    EXPECT_LE(double(times.at(i, j, k)), 1.12 * expected);   // ... and late along diagonals.
  }
}

TEST(MinimalPath, later_sources_start_later) {
  const image::Grid grid = grid_of_size(21, Vec3::Ones());
  const std::array<FrontSource, 3> sources{
      {{grid.offset(0, 10, 10), 0.0F}, {grid.offset(20, 10, 10), 6.0F}, {-1, 0.0F}}};
  const image::ScalarVolume times = arrival_times(uniform(grid, 1.0F), sources);
  EXPECT_FLOAT_EQ(times.at(20, 10, 10), 6.0F);
  EXPECT_FLOAT_EQ(times.at(13, 10, 10), 13.0F);
  EXPECT_EQ(minimal_path(times, grid.offset(18, 10, 10)).size(), 3U);  // From the closer source.
}

TEST(MinimalPath, goes_around_walls_and_stays_within_reach) {
  const image::Grid grid = grid_of_size(31, Vec3::Ones());
  image::ScalarVolume speed = uniform(grid, 1.0F);
  for (Index k = 0; k < 31; ++k)
    for (Index j = 0; j < 31; ++j)
      if (j < 25) speed.at(15, j, k) = 0.0F;  // A wall with an opening at j >= 25.
  const FrontSource source{grid.offset(5, 5, 15)};
  const image::ScalarVolume times = arrival_times(speed, {&source, 1});
  const std::vector<Vec3> path = minimal_path(times, grid.offset(25, 5, 15));
  ASSERT_FALSE(path.empty());
  EXPECT_EQ(path.front(), grid.point_L({5, 5, 15}));
  EXPECT_EQ(path.back(), grid.point_L({25, 5, 15}));
  for (const Vec3& p : path) {
    if (std::abs(p.x() - 15.0) < 0.5) {
      EXPECT_GE(p.y(), 25.0);
    }
  }
  const double shortest_mm = 2.0 * std::hypot(10.0, 20.0);
  EXPECT_NEAR(length_mm(smoothed_path(path, 2.0, 0.5)), shortest_mm, 0.08 * shortest_mm);
  for (Index k = 0; k < 31; ++k)
    for (Index j = 0; j < 31; ++j) speed.at(15, j, k) = 0.0F;
  const image::ScalarVolume closed = arrival_times(speed, {&source, 1});
  EXPECT_EQ(closed.at(25, 5, 15), kNeverReached);
  EXPECT_TRUE(minimal_path(closed, grid.offset(25, 5, 15)).empty());
}

TEST(MinimalPath, stops_at_the_target) {
  const image::Grid grid = grid_of_size(21, Vec3::Ones());
  const FrontSource source{grid.offset(2, 2, 2)};
  const Index target = grid.offset(5, 2, 2);
  const image::ScalarVolume times = arrival_times(uniform(grid, 1.0F), {&source, 1}, target);
  EXPECT_FLOAT_EQ(times.values[std::size_t(target)], 3.0F);
  EXPECT_EQ(times.at(20, 20, 20), kNeverReached);
}

TEST(MinimalPath, smoothing_keeps_ends_and_removes_steps) {
  std::vector<Vec3> steps;
  for (int n = 0; n <= 40; ++n) steps.emplace_back(n, n % 2, 0.0);
  const std::vector<Vec3> path = smoothed_path(steps, 3.0, 0.5);
  EXPECT_EQ(path.front(), steps.front());
  EXPECT_EQ(path.back(), steps.back());
  for (std::size_t n = 20; n + 20 < path.size(); ++n) EXPECT_NEAR(path[n].y(), 0.5, 0.02);
  const std::vector<Vec3> point(3, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(smoothed_path(point, 3.0, 0.5), point);
  EXPECT_TRUE(smoothed_path({}, 3.0, 0.5).empty());
}

}  // namespace
}  // namespace lefort::anatomy
