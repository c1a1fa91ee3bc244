#include <lefort/anatomy/measure_airway.h>
#include <lefort/anatomy/warp_volume.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lefort::anatomy {
namespace {

/// Points every 2.5 mm in a box, moved by a function.
template <class Shift>
std::vector<MovedPoint> points_in(const Box3& box_L, const Shift& shift) {
  constexpr double kStep_mm = 2.5;
  std::vector<MovedPoint> points;
  for (double x = box_L.min().x(); x <= box_L.max().x(); x += kStep_mm)
    for (double y = box_L.min().y(); y <= box_L.max().y(); y += kStep_mm)
      for (double z = box_L.min().z(); z <= box_L.max().z(); z += kStep_mm)
        points.push_back({{x, y, z}, shift(Vec3(x, y, z))});
  return points;
}

const Box3 kBox(Vec3(-30.0, -30.0, -40.0), Vec3(30.0, 30.0, 40.0));

TEST(DisplacementField, follows_the_points_and_fades) {
  const auto linear = [](const Vec3& p) { return Vec3(2.0 + 0.1 * p.x(), -1.0, 0.05 * p.y()); };
  const DisplacementField field(points_in(Box3(Vec3(-25, -25, -25), Vec3(25, 25, 25)), linear),
                                Box3(Vec3(-60, -60, -60), Vec3(60, 60, 60)));
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(10, -7, 5), Vec3(-11, 3, 9)}) {
    EXPECT_LT((field.at(p) - linear(p)).norm(), 0.15) << p.transpose();
    EXPECT_LT((field.before(p + field.at(p)) - p).norm(), 0.01);
  }
  EXPECT_EQ(field.at({55.0, 55.0, 55.0}), Vec3::Zero());
  EXPECT_EQ(field.at({500.0, 0.0, 0.0}), Vec3::Zero());
}

TEST(DisplacementField, does_not_fold_where_points_end) {
  const Vec3 shift(0.0, 0.0, 8.0);
  const DisplacementField field(
      points_in(Box3(Vec3(-10, -10, -10), Vec3(10, 10, 10)), [&](const Vec3&) { return shift; }),
      Box3(Vec3(-60, -60, -60), Vec3(60, 60, 60)));
  EXPECT_LT((field.at({0.0, 0.0, 12.0}) - shift).norm(), 0.2);
  for (double z = 10.0; z < 50.0; z += 1.0) {
    const Vec3 p(0.0, 0.0, z), q(0.0, 0.0, z + 1.0);
    EXPECT_LT((field.at(q) - field.at(p)).norm(), 0.95) << z;
    EXPECT_LT((field.before(p + field.at(p)) - p).norm(), 0.1) << z;
  }
}

TEST(WarpedScan, has_an_airway_that_is_wider) {
  // A tube of 8 mm radius, in tissue that moves away from its axis by a quarter of the radius.
  constexpr double kRadius_mm = 8.0, kWider = 1.25;
  image::Grid grid;
  grid.size = {61, 61, 81};
  grid.origin_L = kBox.min();
  image::CtVolume ct{grid, std::vector<std::int16_t>(std::size_t(grid.voxel_count()))};
  LabelMap labels{grid, std::vector<Tissue>(ct.values.size(), Tissue::kSoftTissue)};
  for (Index v = 0; v < grid.voxel_count(); ++v) {
    const Vec3 p_L = grid.center_L(v);
    const double air = std::clamp(0.5 + kRadius_mm - std::hypot(p_L.x(), p_L.y()), 0.0, 1.0);
    ct.values[std::size_t(v)] = std::int16_t(std::lround(40.0 - 1040.0 * air));
    if (air > 0.5) labels.values[std::size_t(v)] = Tissue::kAirway;
  }
  const DisplacementField field(
      points_in(
          kBox,
          [](const Vec3& p) { return Vec3((kWider - 1.0) * p.x(), (kWider - 1.0) * p.y(), 0.0); }),
      kBox);
  const image::CtVolume after = warped(ct, field, -1000);
  LabelMap labels_after = labels;
  for (Index v = 0; v < grid.voxel_count(); ++v)
    labels_after.values[std::size_t(v)] =
        after.values[std::size_t(v)] < -480 ? Tissue::kAirway : Tissue::kSoftTissue;
  const AirwayLimits limits{{0, 0, 25}, {0, 0, -25}, {0, -25, 0}, Vec3::UnitZ(), -Vec3::UnitY()};
  const auto before = measure_airway(ct, labels, limits);
  const auto wider = measure_airway(after, labels_after, limits);
  ASSERT_TRUE(before) << before.error().message;
  ASSERT_TRUE(wider) << wider.error().message;
  EXPECT_NEAR(wider->volume_ml / before->volume_ml, kWider * kWider, 0.03 * kWider * kWider);
}

}  // namespace
}  // namespace lefort::anatomy
