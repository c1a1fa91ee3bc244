#include <lefort/dental/find_occlusion.h>
#include <lefort/dental/occlusal_relations.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "dental/arch.h"

namespace lefort::dental {
namespace {

constexpr double kSeed = 4.0;  // The edges of its incisors are opposite.

/// Crowns on a parabola, both jaws alike; FDI numbers 1 to 7 of each quadrant.
NumberedCrowns alike_crowns() {
  constexpr double kWidth_mm = 8.0;
  NumberedCrowns crowns;
  for (const int quadrant : {1, 2, 3, 4})
    for (int n = 1; n <= 7; ++n) {
      const double x = 3.5 * (n - 0.5) * (quadrant == 1 || quadrant == 4 ? -1.0 : 1.0);
      crowns[10 * quadrant + n] = {
          Vec3(x, 42.0 * (x / 27.0) * (x / 27.0), quadrant <= 2 ? 4.0 : -4.0), kWidth_mm};
    }
  return crowns;
}

TEST(OcclusalRelations, follow_the_movement_of_the_lower_arch) {
  const NumberedCrowns crowns = alike_crowns();
  const OcclusalRelations before =
      occlusal_relations(crowns, RigidTransform::Identity(), ArchAxes());
  EXPECT_NEAR(before.midline_mm, 0.0, 1e-12);
  EXPECT_NEAR(before.right_canine_mm, before.left_canine_mm, 1e-12);
  // The distal end is half a width behind the center.
  EXPECT_NEAR(before.right_canine_mm, -4.0, 1e-9);
  // The groove is a tenth of the width from the center, the cusp a quarter.
  EXPECT_NEAR(before.left_molar_mm, -0.15 * 8.0, 0.01);
  const RigidTransform X = geometry::rigid_motion(Vec3(2.0, -5.0, 1.0), Vec3::Zero(), Vec3::Zero());
  const OcclusalRelations after = occlusal_relations(crowns, X, ArchAxes());
  EXPECT_NEAR(after.midline_mm, 2.0, 1e-12);
  // Anterior by 5 mm is to mesial, less the slope of the arch.
  EXPECT_GT(after.left_molar_mm, before.left_molar_mm + 3.0);
  EXPECT_GT(after.right_canine_mm, before.right_canine_mm + 2.0);
}

TEST(OcclusalRelations, are_unknown_where_teeth_are_missing) {
  NumberedCrowns crowns = alike_crowns();
  crowns.erase(41);
  crowns.erase(13);
  crowns.erase(26);
  const OcclusalRelations relations =
      occlusal_relations(crowns, RigidTransform::Identity(), ArchAxes());
  EXPECT_TRUE(std::isnan(relations.midline_mm));
  EXPECT_TRUE(std::isnan(relations.right_canine_mm));
  EXPECT_TRUE(std::isnan(relations.left_molar_mm));
  EXPECT_TRUE(std::isfinite(relations.left_canine_mm));
  EXPECT_TRUE(std::isfinite(relations.right_molar_mm));
  EXPECT_EQ(angle_class(relations.right_molar_mm), "I");
  EXPECT_EQ(angle_class(-3.0), "II");
  EXPECT_EQ(angle_class(3.0), "III");
  EXPECT_EQ(angle_class(relations.midline_mm), "");
}

/// The search ends where the requests hold, although the arches touch best elsewhere.
TEST(OcclusalRequests, are_met_without_penetration) {
  const geometry::TriangleMesh upper_L = test::make_arch({.seed = kSeed}, true);
  const geometry::TriangleMesh lower_L = geometry::transformed(
      test::make_arch({.seed = kSeed, .step_mm = 0.4}),
      geometry::rigid_motion(Vec3(0.5, 1.0, -2.0), Vec3::Zero(), Vec3::Zero()));
  OcclusionOptions options{.shift_mm = 2.0, .yaw_deg = 0.0};
  const auto free = find_occlusion(upper_L, lower_L, {}, options);
  ASSERT_TRUE(free) << free.error().message;
  options.requests.overjet_mm = free->overjet_mm + 1.5;
  options.requests.midline_mm = 1.0;
  options.requests.upper_midline_L = Vec3(0.0, 0.0, 6.0);
  options.requests.lower_midline_L = Vec3(0.5, 1.0, 4.0);
  const auto met = find_occlusion(upper_L, lower_L, {}, options);
  ASSERT_TRUE(met) << met.error().message;
  EXPECT_NEAR(met->overjet_mm, *options.requests.overjet_mm, 0.25);
  const Vec3 midline = met->X_L_lower * options.requests.lower_midline_L;
  EXPECT_NEAR(midline.x(), 1.0, 0.25);
  EXPECT_LE(met->contacts.max_penetration_mm, kMaxOcclusalPenetration_mm + 1e-9);
  EXPECT_GT(met->contacts.left_mm2, 0.0);
  EXPECT_GT(met->contacts.right_mm2, 0.0);
  EXPECT_LT(met->contacts.left_mm2 + met->contacts.right_mm2,
            free->contacts.left_mm2 + free->contacts.right_mm2);
}

/// Teeth are rigid: what cannot be met stays different, without penetration.
TEST(OcclusalRequests, do_not_press_teeth_into_each_other) {
  const geometry::TriangleMesh upper_L = test::make_arch({.seed = kSeed}, true);
  const geometry::TriangleMesh lower_L = geometry::transformed(
      test::make_arch({.seed = kSeed, .step_mm = 0.4}),
      geometry::rigid_motion(Vec3(0.0, 0.0, -2.0), Vec3::Zero(), Vec3::Zero()));
  OcclusionOptions options{.shift_mm = 2.0, .yaw_deg = 0.0};
  options.requests.overbite_mm = 6.0;
  const auto found = find_occlusion(upper_L, lower_L, {}, options);
  if (!found) {
    EXPECT_EQ(found.error().code, ErrorCode::kNotConverged);
    return;
  }
  EXPECT_LT(found->overbite_mm, 5.0);
  EXPECT_LE(found->contacts.max_penetration_mm, kMaxOcclusalPenetration_mm + 1e-9);
}

TEST(OcclusalRequests, refuse_what_is_not_finite_or_too_far) {
  const geometry::TriangleMesh upper_L = test::make_arch({.seed = kSeed}, true);
  const geometry::TriangleMesh lower_L = test::make_arch({.seed = kSeed});
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), 11.0, -1e300}) {
    OcclusionOptions options;
    options.requests.overjet_mm = value;
    const auto found = find_occlusion(upper_L, lower_L, {}, options);
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(found.error().message.find("overjet"), std::string::npos);
  }
}

}  // namespace
}  // namespace lefort::dental
