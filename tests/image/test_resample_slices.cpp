#include <lefort/image/resample_slices.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lefort::image::test_resample_slices {
namespace {

/// Smooth over a few pixels, and without any symmetry.
double field_at(const Vec3& p) {
  return 300.0 * std::sin(0.25 * p.x()) + 200.0 * std::cos(0.2 * p.y() + 0.1 * p.x()) +
         10.0 * p.z();
}

struct Slices {
  CtVolume ct;
  std::vector<Vec3> origins_L;
};

Slices slices_at(const Mat3& direction, const std::vector<Vec3>& origins_L) {
  Slices slices{{{.size = {24, 20, std::ssize(origins_L)},
                  .spacing_mm = {0.8, 1.0, 1.0},
                  .origin_L = origins_L.front(),
                  .direction = direction},
                 {}},
                origins_L};
  Grid one = slices.ct.grid;
  for (const Vec3& origin_L : origins_L) {
    one.origin_L = origin_L;
    for (Index j = 0; j < 20; ++j)
      for (Index i = 0; i < 24; ++i)
        slices.ct.values.push_back(
            std::int16_t(std::lround(field_at(one.point_L({double(i), double(j), 0.0})))));
  }
  return slices;
}

/// Max error where all slices have values, at least two pixels from their borders.
double error_within(const CtVolume& straight, const Slices& slices) {
  double maximum = 0.0;
  const Grid& grid = straight.grid;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const Vec3 p = grid.point_L({double(i), double(j), double(k)});
        bool is_within = true;
        for (const Vec3& origin_L : slices.origins_L) {
          const Vec3 at = grid.direction.transpose() * (p - origin_L);
          is_within &= at.x() >= 1.6 && at.x() <= 22 * 0.8 && at.y() >= 2.0 && at.y() <= 18.0;
        }
        if (is_within) maximum = std::max(maximum, std::abs(straight.at(i, j, k) - field_at(p)));
      }
  return maximum;
}

TEST(ResampleGantryTilt, AShearedStackStaysWhereItIsInThePatient) {
  const Mat3 direction =
      Eigen::AngleAxisd(0.4, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  std::vector<Vec3> origins_L;
  for (int k = 0; k < 9; ++k)
    origins_L.push_back(Vec3(3.0, -2.0, 5.0) + direction * Vec3(-0.13 * k, 0.37 * k, 1.5 * k));
  const Slices slices = slices_at(direction, origins_L);
  const Vec3 normal = direction.col(2);
  const Grid grid = regular_grid(slices.ct.grid, origins_L, normal.dot(origins_L[0]), 1.5, 9);
  EXPECT_EQ(grid.size, (std::array<Index, 3>{24 + 2, 20 + 3, 9}));
  const CtVolume straight = resample_slices(slices.ct, origins_L, grid, -1024);
  // Tolerance for rounding, and for cubic convolution of waves of 25 mm.
  EXPECT_LT(error_within(straight, slices), 1.5);
  // The first slice is at one end of the shear; the other end has no values.
  EXPECT_EQ(straight.at(0, 22, 0), -1024);
  EXPECT_NE(straight.at(12, 10, 0), -1024);
}

TEST(ResampleGantryTilt, AWrongSignOfTheShearIsDetected) {
  std::vector<Vec3> origins_L, mirrored;
  for (int k = 0; k < 9; ++k) {
    origins_L.emplace_back(0.0, 0.4 * k, 1.5 * k);
    mirrored.emplace_back(0.0, -0.4 * k, 1.5 * k);
  }
  Slices slices = slices_at(Mat3::Identity(), origins_L);
  const Grid grid = regular_grid(slices.ct.grid, mirrored, 0.0, 1.5, 9);
  const CtVolume straight = resample_slices(slices.ct, mirrored, grid, -1024);
  EXPECT_GT(error_within(straight, slices), 50.0);
}

TEST(ResampleGantryTilt, UnevenHeightsAreInterpolatedLinearly) {
  std::vector<Vec3> origins_L;
  for (const double z : {0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 9.0}) origins_L.emplace_back(0.0, 0.0, z);
  const Slices slices = slices_at(Mat3::Identity(), origins_L);
  const Grid grid = regular_grid(slices.ct.grid, origins_L, 0.0, 1.0, 10);
  EXPECT_EQ(grid.size, (std::array<Index, 3>{24, 20, 10}));
  const CtVolume straight = resample_slices(slices.ct, origins_L, grid, -1024);
  EXPECT_LE(error_within(straight, slices), 1.0);  // The field is linear along z.
  for (std::size_t n = 0; n < 24 * 20; ++n) EXPECT_EQ(straight.values[n], slices.ct.values[n]);
}

}  // namespace
}  // namespace lefort::image::test_resample_slices
