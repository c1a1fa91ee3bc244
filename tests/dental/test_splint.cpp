#include <lefort/dental/splint.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <string>

#include "dental/arch.h"

namespace lefort::dental {
namespace {

constexpr double kOpen_mm = 3.0;

/// Arches that would touch everywhere, opened by kOpen_mm, with gingiva below the lower crowns.
geometry::TriangleMesh upper_arch() {
  RigidTransform X = RigidTransform::Identity();
  X.translation() = Vec3(0.0, 0.0, kOpen_mm);
  return geometry::transformed(test::make_arch({.seed = 3.0}, true), X);
}
geometry::TriangleMesh lower_arch() {
  return test::make_arch({.seed = 3.0, .step_mm = 0.4, .skirt_mm = 2.0});
}

TEST(Splint, fits_both_arches) {
  const auto splint = make_splint(upper_arch(), lower_arch(), {});
  ASSERT_TRUE(splint) << splint.error().message;
  EXPECT_TRUE(geometry::is_closed(splint->surface_L));
  EXPECT_EQ(geometry::connected_components(splint->surface_L).count, 1);
  EXPECT_EQ(geometry::euler_characteristic(splint->surface_L), 2);  // A horseshoe without holes.
  EXPECT_GT(splint->volume_ml, 2.0);
  // Cusps oppose fissures with the same slope, so the clearance is larger along the direction of
  // insertion than along the normal.
  EXPECT_GT(splint->min_thickness_mm, 1.5);
  EXPECT_LT(splint->min_thickness_mm, kOpen_mm - 2.0 * 0.1 + 0.05);
  for (const SplintFit& fit : {splint->upper, splint->lower}) {
    EXPECT_GT(fit.p5_mm, 0.05);
    EXPECT_GT(fit.median_mm, 0.08);
    EXPECT_LT(fit.median_mm, 0.13);
    EXPECT_LT(fit.p95_mm, 0.35);  // In fissures and between teeth the splint is not at the ground.
    EXPECT_LT(fit.max_penetration_mm, 0.01);
  }
}

TEST(Splint, follows_the_directions_of_the_arches) {
  RigidTransform X(Eigen::AngleAxisd(0.4, Vec3(0.3, -0.2, 0.9).normalized()));
  X.translation() = Vec3(10.0, -40.0, 25.0);
  ArchAxes axes;
  axes.superior_L = X.linear() * axes.superior_L;
  axes.anterior_L = X.linear() * axes.anterior_L;
  const auto here = make_splint(upper_arch(), lower_arch(), {}, {.voxel_mm = 0.3});
  const auto there = make_splint(geometry::transformed(upper_arch(), X),
                                 geometry::transformed(lower_arch(), X), axes, {.voxel_mm = 0.3});
  ASSERT_TRUE(here && there);
  EXPECT_NEAR(there->volume_ml, here->volume_ml, 0.01 * here->volume_ml);
  EXPECT_NEAR(there->min_thickness_mm, here->min_thickness_mm, 0.05);
}

TEST(Splint, has_holes_where_the_arches_touch) {
  const auto splint =
      make_splint(test::make_arch({.seed = 3.0}, true), lower_arch(), {}, {.voxel_mm = 0.3});
  ASSERT_TRUE(splint) << splint.error().message;
  EXPECT_LT(splint->min_thickness_mm, 0.0);
}

TEST(Splint, refuses_what_is_not_two_arches_in_mm) {
  EXPECT_FALSE(make_splint({}, lower_arch(), {}));
  EXPECT_FALSE(make_splint(upper_arch(), lower_arch(), {}, {.clearance_mm = -0.1}));
  EXPECT_FALSE(make_splint(upper_arch(), lower_arch(), {}, {.voxel_mm = 0.01}));
  RigidTransform away = RigidTransform::Identity();
  away.translation() = Vec3(0.0, 0.0, 40.0);
  EXPECT_FALSE(make_splint(geometry::transformed(upper_arch(), away), lower_arch(), {}));
  const auto swapped = make_splint(lower_arch(), upper_arch(), {}, {.voxel_mm = 0.5});
  ASSERT_FALSE(swapped);
  EXPECT_NE(swapped.error().message.find("swapped"), std::string::npos) << swapped.error().message;
  geometry::TriangleMesh meters = lower_arch();
  for (Vec3& p : meters.vertices) p *= 1000.0;
  EXPECT_FALSE(make_splint(upper_arch(), meters, {}));
}

}  // namespace
}  // namespace lefort::dental
