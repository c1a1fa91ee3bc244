#include <lefort/contact/step_bound.h>
#include <lefort/field/build/build_distance_field.h>

#include <gtest/gtest.h>

#include <memory>

#include "support/shapes.h"

namespace lefort::contact::test_step_bound {
namespace {

/// A plate of 1 mm between z = -1 and z = 0.
RigidObstacle plate() {
  static const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(test::make_box({-10, -10, -1}, {10, 10, 0}),
                                  {.resolution = 128, .band_mm = 3.0, .smooth = true})
          .value());
  return {field_distance_query(field, DetectionMethod::kSmooth).value()};
}

TEST(AllowedFraction, EndsInsideTheFirstHalfOfAPlateHoweverLargeTheStep) {
  for (const double step_mm : {3.0, 30.0, 300.0}) {
    const double fraction = allowed_fraction(plate(), Vec3(1, 2, 1.5), Vec3(0, 0, -step_mm));
    const double z = 1.5 - fraction * step_mm;
    EXPECT_GT(z, -0.6) << step_mm;
    EXPECT_LT(z, 0.0) << step_mm;
  }
}

TEST(AllowedFraction, APointInThePlateMayLeaveOnItsSideOnly) {
  EXPECT_EQ(allowed_fraction(plate(), Vec3(1, 2, -0.2), Vec3(0, 0, 5)), 1.0);
  EXPECT_LT(allowed_fraction(plate(), Vec3(1, 2, -0.2), Vec3(0, 0, -5)), 0.1);
}

TEST(AllowedFraction, IsOneWithoutAPassage) {
  EXPECT_EQ(allowed_fraction(plate(), Vec3(1, 2, 1.5), Vec3(5, 0, 0)), 1.0);
  EXPECT_EQ(allowed_fraction(plate(), Vec3(1, 2, 1.5), Vec3(0, 0, -1.7)), 1.0);
  EXPECT_EQ(allowed_fraction(plate(), Vec3(1, 2, 40), Vec3(0, 0, 300)), 1.0);
  EXPECT_EQ(allowed_fraction(plate(), Vec3(1, 2, 0.1), Vec3::Zero()), 1.0);
}

TEST(AllowedFraction, FollowsThePoseOfTheBone) {
  RigidObstacle moved = plate();
  moved.X_LB.translation() = Vec3(0, 0, 20);
  EXPECT_EQ(allowed_fraction(moved, Vec3(1, 2, 1.5), Vec3(0, 0, -3)), 1.0);
  EXPECT_LT(allowed_fraction(moved, Vec3(1, 2, 21.5), Vec3(0, 0, -3)), 0.75);
}

}  // namespace
}  // namespace lefort::contact::test_step_bound
