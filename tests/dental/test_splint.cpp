#include <lefort/core/parallel.h>
#include <lefort/dental/splint.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

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
  for (const InsertionFit& fit : {splint->upper, splint->lower}) {
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

/// Size along left, posterior and superior.
Vec3 size_of(const SplintOptions& options) {
  const auto splint = make_splint(upper_arch(), lower_arch(), {}, options);
  EXPECT_TRUE(splint) << splint.error().message;
  return splint ? Vec3(geometry::bounding_box(splint->surface_L).sizes()) : Vec3(Vec3::Zero());
}

TEST(Splint, follows_its_options) {
  const Vec3 size = size_of({.rim_mm = 2.5, .edge_mm = 0.0, .voxel_mm = 0.3});
  const Vec3 wide = size_of({.wall_mm = 4.5, .rim_mm = 4.5, .edge_mm = 0.0, .voxel_mm = 0.3});
  EXPECT_NEAR(wide.x() - size.x(), 4.0, 0.3);  // 2 mm on both sides.
  EXPECT_NEAR(wide.y() - size.y(), 4.0, 0.3);
  EXPECT_NEAR(wide.z() - size.z(), 0.0, 1.0);  // No rim far beyond the cover.
  const Vec3 high = size_of({.cover_mm = 4.0, .rim_mm = 2.5, .edge_mm = 0.0, .voxel_mm = 0.3});
  EXPECT_NEAR(high.z() - size.z(), 3.0, 0.5);  // 1.5 mm over both arches.
  const auto loose =
      make_splint(upper_arch(), lower_arch(), {}, {.clearance_mm = 0.3, .voxel_mm = 0.3});
  ASSERT_TRUE(loose);
  EXPECT_NEAR(loose->lower.median_mm, 0.3, 0.05);
}

/// Volume of a splint [ml].
double volume_of(const SplintOptions& options) {
  const auto splint = make_splint(upper_arch(), lower_arch(), {}, options);
  EXPECT_TRUE(splint) << splint.error().message;
  return splint ? splint->volume_ml : 0.0;
}

TEST(Splint, has_a_rim_and_round_edges) {
  const double plain = volume_of({.rim_mm = 2.5, .edge_mm = 0.0, .voxel_mm = 0.3});
  const double thin = volume_of({.rim_mm = 1.2, .edge_mm = 0.0, .voxel_mm = 0.3});
  const double round = volume_of({.rim_mm = 2.5, .edge_mm = 1.2, .voxel_mm = 0.3});
  // Four walls (two arches, two sides) along 120 mm of arch lose 1.3 mm over most of 2.5 mm.
  EXPECT_GT(plain - thin, 4.0 * 0.12 * 1.3 * 1.0);
  EXPECT_LT(plain - thin, 4.0 * 0.12 * 1.3 * 2.5);
  // Four edges lose (1 - pi / 4) r^2 each.
  const double lost_ml = 4.0 * 0.12 * 0.2146 * 1.2 * 1.2;
  EXPECT_NEAR(plain - round, lost_ml, 0.5 * lost_ml);
  EXPECT_FALSE(make_splint(upper_arch(), lower_arch(), {}, {.rim_mm = 2.6}));
  EXPECT_FALSE(make_splint(upper_arch(), lower_arch(), {}, {.rim_mm = 2.0, .edge_mm = 1.1}));
}

/// A bar of 8 by 2 mm, and one of 1 by 2 mm at the end.
TextMask two_bars() {
  TextMask mask{120, 20, 0.1, std::vector<float>(120 * 20, 0.0F)};
  for (Index row = 0; row < 20; ++row)
    for (Index column = 0; column < 120; ++column)
      if (column < 80 || column >= 110) mask.coverage[std::size_t(column + 120 * row)] = 1.0F;
  return mask;
}

TEST(Splint, has_engraved_text) {
  const auto plain = make_splint(upper_arch(), lower_arch(), {}, {});
  const auto engraved = make_splint(upper_arch(), lower_arch(), {}, {.text = two_bars()});
  ASSERT_TRUE(plain && engraved) << engraved.error().message;
  EXPECT_TRUE(geometry::is_closed(engraved->surface_L));
  EXPECT_EQ(geometry::euler_characteristic(engraved->surface_L), 2);
  // 18 mm^2, 0.6 mm deep.
  EXPECT_NEAR(plain->volume_ml - engraved->volume_ml, 0.0108, 0.002);
  // From the front the text reads from the patient's right to left: two thirds of it are on the
  // right of its middle.
  std::vector<double> across;
  const geometry::Bvh before(plain->surface_L);
  for (const Vec3& p : engraved->surface_L.vertices)
    if ((before.closest_point(p)->point - p).norm() > 0.5) across.push_back(p.x());
  ASSERT_GT(across.size(), 100U);
  const auto [right, left] = std::minmax_element(across.begin(), across.end());
  const double middle = 0.5 * (*right + *left);
  const auto count =
      std::count_if(across.begin(), across.end(), [&](double x) { return x < middle; });
  EXPECT_GT(double(count), 0.58 * double(across.size()));
  EXPECT_NEAR(middle, 0.0, 3.0);
  EXPECT_EQ(plain->upper.median_mm, engraved->upper.median_mm);
  TextMask tall = two_bars();
  tall.pixel_mm = 1.5;  // 30 mm high.
  const auto refused = make_splint(upper_arch(), lower_arch(), {}, {.text = tall});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
}

/// Crowns that bulge by 1 mm below their edge: an offset surface alone would lock there.
TEST(Splint, has_no_undercuts) {
  geometry::TriangleMesh lower = lower_arch();
  for (Vec3& p : lower.vertices) {
    const double below_mm = std::clamp(5.0 - p.z(), 0.0, 2.0);
    p.x() *= 1.0 + 0.04 * below_mm * (2.0 - below_mm);
  }
  const auto splint = make_splint(upper_arch(), lower, {}, {.cover_mm = 4.0});
  ASSERT_TRUE(splint) << splint.error().message;
  EXPECT_LT(splint->lower.max_penetration_mm, 0.01);  // On the whole way in.
}

/// The upper incisors overlap the lower ones by 3 mm, the molars are open: no hole at the incisors.
TEST(Splint, covers_a_deep_bite) {
  geometry::TriangleMesh upper = upper_arch();
  for (Vec3& p : upper.vertices) {
    const double front = std::clamp((12.0 - p.y()) / 6.0, 0.0, 1.0);
    p += front * Vec3(0.0, -9.0, -5.0);  // Before the lower incisors and 3 mm below their edges.
  }
  const auto splint = make_splint(upper, lower_arch(), {}, {.voxel_mm = 0.3});
  ASSERT_TRUE(splint) << splint.error().message;
  EXPECT_EQ(splint->parts, 1);
  EXPECT_LT(splint->lower.p95_mm, 0.6);  // Also the incisors are covered.
}

TEST(Splint, is_the_same_for_any_number_of_threads) {
  std::vector<Vec3> vertices[2];
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const auto splint = make_splint(upper_arch(), lower_arch(), {}, {.voxel_mm = 0.5});
    ASSERT_TRUE(splint);
    vertices[threads == 1 ? 0 : 1] = splint->surface_L.vertices;
  }
  EXPECT_EQ(vertices[0], vertices[1]);
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
  const auto swapped = make_splint(lower_arch(), upper_arch(), {});
  ASSERT_FALSE(swapped);
  EXPECT_NE(swapped.error().message.find("swapped"), std::string::npos) << swapped.error().message;
  geometry::TriangleMesh meters = lower_arch();
  for (Vec3& p : meters.vertices) p *= 1000.0;
  EXPECT_FALSE(make_splint(upper_arch(), meters, {}));
}

}  // namespace
}  // namespace lefort::dental
