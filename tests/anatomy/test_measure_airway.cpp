#include <lefort/anatomy/measure_airway.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace lefort::anatomy {
namespace {

constexpr double kPi = std::numbers::pi;

/// Depth in the airway [mm], positive inside, exact near the wall.
using Shape = std::function<double(const Vec3&)>;

struct Scan {
  image::CtVolume ct;
  LabelMap labels;
};

/// Partial volume follows the depth; noise of 20 HU.
Scan scan_of_shape(const Shape& depth, const Vec3& spacing_mm, double turn_rad = 0.0) {
  Scan scan;
  image::Grid& grid = scan.ct.grid;
  grid.spacing_mm = spacing_mm;
  grid.direction = Eigen::AngleAxisd(turn_rad, Vec3(1.0, 0.5, 0.2).normalized()).toRotationMatrix();
  const Vec3 extent_mm(60.0, 60.0, 90.0);
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.size[axis] = Index(extent_mm[Index(axis)] / spacing_mm[Index(axis)]);
  grid.origin_L = -0.5 * (grid.direction * extent_mm);
  scan.labels.grid = grid;
  std::mt19937 bits(7);
  std::normal_distribution<double> noise(0.0, 20.0);
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        // Mean of 27 points of the voxel.
        double air = 0.0;
        for (int n = 0; n < 27; ++n) {
          const Vec3 at(double(i) + (n % 3 - 1) / 3.0, double(j) + (n / 3 % 3 - 1) / 3.0,
                        double(k) + (n / 9 - 1) / 3.0);
          air += std::clamp(0.5 + depth(grid.point_L(at)) / 0.3, 0.0, 1.0) / 27.0;
        }
        scan.ct.values.push_back(
            std::int16_t(std::clamp(40.0 - 1040.0 * air + noise(bits), -1024.0, 3000.0)));
        scan.labels.values.push_back(air > 0.5 ? Tissue::kAirway : Tissue::kSoftTissue);
      }
  return scan;
}

AirwayLimits limits_at(double upper_mm, double lower_mm) {
  return {
      {0.0, 0.0, upper_mm}, {0.0, 0.0, lower_mm}, {0.0, -25.0, 0.0}, Vec3::UnitZ(), -Vec3::UnitY()};
}

TEST(MeasureAirway, elliptical_cylinder_within_3_percent) {
  const double a = 9.0, b = 5.0;
  const auto cylinder = [&](const Vec3& p) {
    const double r = std::hypot(p.x() / a, p.y() / b);
    return (1.0 - r) * r / std::hypot(p.x() / (a * a), p.y() / (b * b));
  };
  for (const auto& [spacing_mm, turn_rad] :
       {std::pair{Vec3(0.5, 0.5, 1.0), 0.0}, {Vec3(0.9, 0.9, 0.9), 0.3}}) {
    const Scan scan = scan_of_shape(cylinder, spacing_mm, turn_rad);
    const auto airway = measure_airway(scan.ct, scan.labels, limits_at(20.0, -20.3));
    ASSERT_TRUE(airway) << airway.error().message;
    EXPECT_NEAR(airway->volume_ml, kPi * a * b * 40.3e-3, 0.03 * kPi * a * b * 40.3e-3);
    EXPECT_NEAR(airway->length_mm, 40.3, 2.0);
    EXPECT_EQ(airway->closed_mm, 0.0);
    const AirwaySection& middle = airway->sections[airway->sections.size() / 2];
    EXPECT_NEAR(middle.area_mm2, kPi * a * b, 0.03 * kPi * a * b);
    EXPECT_NEAR(middle.width_mm, 2.0 * a, 0.7);
    EXPECT_NEAR(middle.depth_mm, 2.0 * b, 0.7);
    EXPECT_NEAR(airway->axial[airway->min_axial].area_mm2, kPi * a * b, 0.05 * kPi * a * b);
  }
}

TEST(MeasureAirway, hourglass_within_3_percent) {
  const auto radius_mm = [](double z) { return 4.0 + 5.0 * z * z / 900.0; };
  const Scan scan = scan_of_shape(
      [&](const Vec3& p) {
        return (radius_mm(p.z() - 5.0) - std::hypot(p.x(), p.y())) /
               std::hypot(1.0, 10.0 * (p.z() - 5.0) / 900.0);
      },
      {0.5, 0.5, 0.5});
  const auto airway = measure_airway(scan.ct, scan.labels, limits_at(30.0, -25.0));
  ASSERT_TRUE(airway) << airway.error().message;
  double volume_mm3 = 0.0;
  for (double z = -24.95; z < 30.0; z += 0.1)
    volume_mm3 += 0.1 * kPi * std::pow(radius_mm(z - 5.0), 2);
  EXPECT_NEAR(airway->volume_ml, volume_mm3 * 1e-3, 0.03 * volume_mm3 * 1e-3);
  const AirwaySection& narrow = airway->sections[airway->min_section];
  EXPECT_NEAR(narrow.area_mm2, kPi * 16.0, 0.03 * kPi * 16.0);
  EXPECT_NEAR(narrow.center_L.z(), 5.0, 2.5);
}

TEST(MeasureAirway, sections_of_a_bent_tube_are_normal_to_it) {
  // A quarter of a torus about x, from the top plane to the back; only its axial sections grow.
  const double bend_mm = 30.0, radius_mm = 6.0;
  const Scan scan = scan_of_shape(
      [&](const Vec3& p) {
        const double around = std::hypot(p.y() - 20.0, p.z() - 20.0);
        return radius_mm - std::hypot(p.x(), around - bend_mm);
      },
      {0.7, 0.7, 0.7});
  AirwayLimits limits = limits_at(20.0, -8.0);
  limits.front_L.y() = -30.0;
  const auto airway = measure_airway(scan.ct, scan.labels, limits);
  ASSERT_TRUE(airway) << airway.error().message;
  const double area_mm2 = kPi * radius_mm * radius_mm;
  const AirwaySection& middle = airway->sections[airway->sections.size() / 2];
  EXPECT_NEAR(middle.area_mm2, area_mm2, 0.05 * area_mm2);
  EXPECT_GT(airway->axial[2 * airway->axial.size() / 3].area_mm2, 1.15 * area_mm2);
}

TEST(MeasureAirway, closed_airway_has_sections_without_area) {
  const Scan scan = scan_of_shape(
      [](const Vec3& p) { return std::min(6.0 - std::hypot(p.x(), p.y()), std::abs(p.z()) - 3.0); },
      {0.6, 0.6, 0.6});
  const auto airway = measure_airway(scan.ct, scan.labels, limits_at(20.0, -20.0));
  ASSERT_TRUE(airway) << airway.error().message;
  EXPECT_EQ(airway->sections[airway->min_section].area_mm2, 0.0);
  EXPECT_NEAR(airway->closed_mm, 6.0, 4.0);
  EXPECT_NEAR(airway->volume_ml, kPi * 36.0 * 34.0e-3, 0.03 * kPi * 36.0 * 34.0e-3);
}

TEST(MeasureAirway, air_in_front_is_not_measured) {
  const auto box = [](const Vec3& p) {
    return std::min(8.0 - std::abs(p.x()), 12.0 - std::abs(p.y()));
  };
  const Scan scan = scan_of_shape(box, {0.6, 0.6, 0.6});
  AirwayLimits limits = limits_at(15.0, -15.0);
  limits.front_L.y() = 0.0;
  const auto airway = measure_airway(scan.ct, scan.labels, limits);
  ASSERT_TRUE(airway) << airway.error().message;
  EXPECT_NEAR(airway->volume_ml, 16.0 * 12.0 * 30.0e-3, 0.03 * 5.76);
}

TEST(MeasureAirway, refuses_no_air_and_exchanged_planes) {
  const Scan scan = scan_of_shape([](const Vec3&) { return -5.0; }, {2.0, 2.0, 2.0});
  const auto none = measure_airway(scan.ct, scan.labels, limits_at(10.0, -10.0));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kAnatomyMissing);
  const auto exchanged = measure_airway(scan.ct, scan.labels, limits_at(-10.0, 10.0));
  ASSERT_FALSE(exchanged);
  EXPECT_EQ(exchanged.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::anatomy
