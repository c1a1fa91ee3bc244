#include <lefort/core/parallel.h>
#include <lefort/dental/cutting_guide.h>
#include <lefort/dental/guide_holes.h>
#include <lefort/geometry/mesh_properties.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "support/shapes.h"
#include "support/stop_at_once.h"

namespace lefort::dental {
namespace {

constexpr double kSaw_mm = 0.8;

/// A sphere of bone, cut at z = 0; the segment is below. Seen from anterior (-y).
struct Ball {
  geometry::Bvh bone{test::make_icosphere(25.0, 6)};
  geometry::Bvh solid{test::make_box({-200.0, -200.0, -200.0}, {200.0, 200.0, 0.0})};
  GuideSite site{bone, solid, kSaw_mm, -Vec3::UnitY()};

  /// The cut face: a disk.
  [[nodiscard]] static geometry::TriangleMesh face() {
    constexpr int kCorners = 180;
    geometry::TriangleMesh disk;
    disk.vertices.emplace_back(Vec3::Zero());
    for (int n = 0; n < kCorners; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / kCorners;
      disk.vertices.emplace_back(25.0 * std::cos(angle), 25.0 * std::sin(angle), 0.0);
      disk.triangles.push_back({0, 1 + n, 1 + (n + 1) % kCorners});
    }
    return disk;
  }
  [[nodiscard]] CutLine line() const {
    return visible_cut_lines(face(), bone, site.outward_L, 12.0).at(0);
  }
};

double nothing_near(const Vec3&, const Vec3&) { return std::numeric_limits<double>::infinity(); }

TEST(CutLine, is_what_the_surgeon_sees) {
  const Ball ball;
  const auto lines = visible_cut_lines(Ball::face(), ball.bone, ball.site.outward_L, 12.0);
  ASSERT_EQ(lines.size(), 1U);
  // 60 degrees to both sides.
  EXPECT_NEAR(lines[0].last_mm(), 25.0 * std::sin(std::numbers::pi / 3.0), 0.6);
  EXPECT_NEAR(lines[0].first_mm(), -25.0 * std::sin(std::numbers::pi / 3.0), 0.6);
  EXPECT_NEAR(std::abs(lines[0].along_L.x()), 1.0, 1e-3);
  for (const Vec3& p : lines[0].points_L) EXPECT_LT(p.y(), -11.0);

  // Another bone in front hides it.
  geometry::TriangleMesh both = test::make_box({-30.0, -60.0, -30.0}, {30.0, -50.0, 30.0});
  const auto first = std::int32_t(both.vertices.size());
  const geometry::TriangleMesh& sphere = ball.bone.mesh();
  both.vertices.insert(both.vertices.end(), sphere.vertices.begin(), sphere.vertices.end());
  for (const auto& [a, b, c] : sphere.triangles)
    both.triangles.push_back({a + first, b + first, c + first});
  EXPECT_TRUE(
      visible_cut_lines(Ball::face(), geometry::Bvh(both), ball.site.outward_L, 12.0).empty());
}

TEST(CuttingGuide, fits_and_has_slots_and_bridges) {
  const Ball ball;
  const CutLine line = ball.line();
  const GuideOptions options{.max_slot_mm = 20.0};
  const auto holes = choose_holes(ball.site, line, options, {}, nothing_near);
  ASSERT_EQ(holes.size(), 6U);
  const auto guide = make_guide(ball.site, line, holes, 1.5, options);
  ASSERT_TRUE(guide) << guide.error().message;
  EXPECT_TRUE(geometry::is_closed(guide->surface_L));
  EXPECT_EQ(guide->parts, 1);
  // Two slots and six holes: eight handles.
  EXPECT_EQ(geometry::euler_characteristic(guide->surface_L), 2 - 2 * 8);
  EXPECT_GT(guide->fit.p5_mm, 0.05);
  EXPECT_NEAR(guide->fit.median_mm, 0.1, 0.02);
  EXPECT_LT(guide->fit.p95_mm, 0.15);
  EXPECT_LT(guide->fit.max_penetration_mm, 0.01);
  EXPECT_NEAR(guide->slot_width_mm, kSaw_mm + 2.0 * options.slot_clearance_mm, 1e-12);
  EXPECT_NEAR(guide->slot_mm, line.last_mm() - line.first_mm() - 3.0 * options.bridge_mm, 1e-9);

  // In the middle of the guide's thickness, at the middle of the saw.
  const geometry::Bvh body(guide->surface_L);
  const auto level = [&](double x) {
    const double radius = 25.0 + options.clearance_mm + 0.5 * options.thickness_mm;
    const Vec3 p(x, -std::sqrt(radius * radius - x * x), 0.5 * kSaw_mm);
    return body.signed_distance(p).distance_mm;
  };
  EXPECT_LT(level(0.0), -0.5);  // The bridge between both slots.
  for (const double x : {-16.0, -8.0, -3.0, 3.0, 8.0, 16.0})
    EXPECT_NEAR(level(x), 0.5 * guide->slot_width_mm, 0.1) << x;
  for (const double x : {-20.5, 20.5}) EXPECT_LT(level(x), -0.3) << x;
  for (const GuideHole& hole : holes) {
    const Vec3 p = hole.point_L + 1.6 * hole.axis_L;
    EXPECT_NEAR(body.signed_distance(p).distance_mm, 0.75, 0.1);
  }
}

TEST(CuttingGuide, holes_are_beside_the_cut_and_clear) {
  const Ball ball;
  const CutLine line = ball.line();
  // A root below the middle of the segment.
  const Vec3 root(0.0, -22.0, -5.0);
  const auto clear_of = [&](const Vec3& from, const Vec3& to) {
    const double t = std::clamp((root - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    return (root - from - t * (to - from)).norm();
  };
  const HoleOptions options;
  const auto holes = choose_holes(ball.site, line, {}, options, clear_of);
  ASSERT_EQ(holes.size(), 6U);
  for (const GuideHole& hole : holes) {
    EXPECT_NEAR(hole.point_L.norm(), 25.0, 0.05);
    EXPECT_EQ(hole.is_on_segment, hole.point_L.z() < 0.0);
    const double from_cut = hole.is_on_segment ? -hole.point_L.z() : hole.point_L.z() - kSaw_mm;
    EXPECT_NEAR(from_cut, options.from_cut_mm, 2.0);
    EXPECT_GT(hole.axis_L.dot(hole.point_L) / 25.0, 0.99);
    EXPECT_GE(clear_of(hole.point_L, hole.point_L - options.depth_mm * hole.axis_L) - 0.75,
              options.min_clear_mm);
    EXPECT_GE(hole.clear_mm, options.min_clear_mm);
    EXPECT_NEAR(hole.bone_mm, 20.0, 1e-9);  // 50 mm, reported as 20.
  }
  // Nothing is clear: no holes.
  EXPECT_TRUE(choose_holes(ball.site, line, {}, options, [](auto&&...) { return 1.0; }).empty());
}

TEST(CuttingGuide, same_bits_for_any_number_of_threads) {
  const Ball ball;
  const CutLine line = ball.line();
  const auto made = [&](int threads) {
    const ThreadLimit limit(threads);
    return make_guide(ball.site, line, {}, 1.5, {.voxel_mm = 0.5});
  };
  const auto one = made(1), three = made(3);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->surface_L.vertices, three->surface_L.vertices);
}

TEST(CuttingGuide, refuses_bad_options) {
  const Ball ball;
  for (const GuideOptions& bad :
       {GuideOptions{.clearance_mm = -0.1}, GuideOptions{.thickness_mm = 1.0},
        GuideOptions{.bridge_mm = 0.0}, GuideOptions{.voxel_mm = std::nan("")}}) {
    const auto guide = make_guide(ball.site, ball.line(), {}, 1.5, bad);
    ASSERT_FALSE(guide);
    EXPECT_EQ(guide.error().code, ErrorCode::kInvalidArgument);
  }
  EXPECT_FALSE(check_holes({.from_cut_mm = 8.0}, {.width_mm = 9.0}));
  EXPECT_FALSE(check_holes({.diameter_mm = 0.0}, {}));
  test::StopAtOnce stop;
  const auto guide = make_guide(ball.site, ball.line(), {}, 1.5, {}, stop);
  ASSERT_FALSE(guide);
  EXPECT_EQ(guide.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::dental
