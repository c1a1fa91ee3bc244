#include <lefort/image/radiograph.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lefort::image {
namespace {

/// A box of water of 40 x 30 x 20 mm about the origin, in air, on an oblique grid.
CtVolume box_of_water() {
  CtVolume ct;
  ct.grid.size = {96, 96, 96};
  ct.grid.spacing_mm = {0.6, 0.6, 0.6};
  ct.grid.direction = Eigen::AngleAxisd(0.4, Vec3(0.3, 1.0, 0.2).normalized()).toRotationMatrix();
  ct.grid.origin_L = -ct.grid.direction * Vec3::Constant(0.3 * 95);
  ct.values.reserve(std::size_t(ct.grid.voxel_count()));
  for (Index k = 0; k < 96; ++k)
    for (Index j = 0; j < 96; ++j)
      for (Index i = 0; i < 96; ++i) {
        const Vec3 p = ct.grid.point_L({double(i), double(j), double(k)});
        const bool inside =
            std::abs(p.x()) < 20.0 && std::abs(p.y()) < 15.0 && std::abs(p.z()) < 10.0;
        ct.values.push_back(inside ? 0 : -1000);
      }
  return ct;
}

RadiographView view_along_x() {
  RadiographView view;  // Rays along right_L x down_L, -x.
  view.down_L = -Vec3::UnitZ();
  view.right_L = Vec3::UnitY();
  view.columns = 80;
  view.rows = 60;
  view.pixel_mm = 0.5;
  return view;
}

/// Columns of the middle row that see more than half of the largest thickness.
int shadow_columns(const std::vector<double>& water_mm, const RadiographView& view) {
  const auto row = water_mm.begin() + std::ptrdiff_t(view.rows / 2) * view.columns;
  return int(std::count_if(row, row + view.columns, [](double t) { return t > 20.0; }));
}

TEST(Radiograph, parallel_rays_measure_the_thickness_of_water) {
  const RadiographView view = view_along_x();
  const std::vector<double> water_mm = radiograph(box_of_water(), view, 0.2);
  ASSERT_EQ(water_mm.size(), 80U * 60U);
  EXPECT_NEAR(water_mm[30 * 80 + 40], 40.0, 0.5);
  EXPECT_NEAR(water_mm.front(), 0.0, 1e-9);
  EXPECT_NEAR(shadow_columns(water_mm, view), 60, 2);  // 30 mm.
}

TEST(Radiograph, scale_of_a_central_projection_is_that_of_the_plane) {
  const CtVolume ct = box_of_water();
  RadiographView view = view_along_x();
  view.source_mm = 200.0;
  // The side of the box towards the source is 20 mm closer to it: larger by 200 / 180.
  const std::vector<double> water_mm = radiograph(ct, view, 0.2);
  EXPECT_NEAR(water_mm[30 * 80 + 40], 40.0, 0.5);
  const auto row = water_mm.begin() + 30 * 80;
  const auto seen = std::count_if(row, row + 80, [](double t) { return t > 1.0; });
  EXPECT_NEAR(double(seen), 60.0 * 200.0 / 180.0, 3.0);
  EXPECT_NEAR(shadow_columns(water_mm, view), 60, 2);  // The middle plane.
}

TEST(Radiograph, rays_beside_the_grid_see_nothing) {
  RadiographView view = view_along_x();
  view.center_L = Vec3(0.0, 500.0, 0.0);
  for (const double t : radiograph(box_of_water(), view, 0.5)) EXPECT_EQ(t, 0.0);
}

}  // namespace
}  // namespace lefort::image
