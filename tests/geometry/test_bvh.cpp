#include <lefort/geometry/bvh.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "support/shapes.h"

namespace lefort::geometry::test_bvh {
namespace {

Vec3 random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> in(-size, size);
  return {in(random), in(random), in(random)};
}

/// A ball with deep dents and thin ridges: saddle, convex and concave vertices, slivers.
TriangleMesh make_crumpled_ball(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(0.5, 1.5);
  TriangleMesh ball = test::make_icosphere(1.0, 2);
  for (Vec3& v : ball.vertices) v *= radius(random);
  return ball;
}

SurfacePoint brute_force(const TriangleMesh& mesh, const Vec3& p) {
  SurfacePoint best{p, 0.0, -1, Feature::kFace};
  double best_squared = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const TrianglePoint found =
        closest_point_on_triangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    if (found.squared_distance_mm2 >= best_squared) continue;
    best_squared = found.squared_distance_mm2;
    best = {found.point, std::sqrt(best_squared), t, found.feature};
  }
  return best;
}

/// Points everywhere, and close to features where signs are difficult.
std::vector<Vec3> hard_points(const TriangleMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Vec3> points;
  for (int n = 0; n < 500; ++n) points.push_back(random_point(random, 2.0));
  for (const Vec3& v : mesh.vertices)
    for (const double near : {1e-1, 1e-3, 1e-6}) points.push_back(v + random_point(random, near));
  return points;
}

void expect_signs_of_winding(const TriangleMesh& mesh, unsigned seed) {
  const Bvh bvh(mesh);
  for (const Vec3& p : hard_points(mesh, seed)) {
    const double d = bvh.signed_distance(p).distance_mm;
    const double winding = winding_number(mesh, p);
    if (std::abs(d) < 1e-9) continue;
    EXPECT_EQ(d<0.0, winding> 0.5) << "at " << p.transpose() << ", distance " << d;
  }
}

TEST(Bvh, MatchesBruteForce) {
  const TriangleMesh mesh = make_crumpled_ball(3);
  const Bvh bvh(mesh);
  for (const Vec3& p : hard_points(mesh, 4)) {
    const auto found = bvh.closest_point(p);
    const SurfacePoint expected = brute_force(mesh, p);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->distance_mm, expected.distance_mm);
    EXPECT_EQ(found->triangle, expected.triangle);
    EXPECT_EQ(found->feature, expected.feature);
  }
}

TEST(Bvh, EquallyNearTrianglesGiveTheLowestNumber) {
  const TriangleMesh box = test::make_box(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  const auto found = Bvh(box).closest_point(Vec3::Zero());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->triangle, 0);
  EXPECT_EQ(found->distance_mm, 1.0);
}

TEST(Bvh, SearchesUpToTheMaxDistance) {
  const Bvh bvh(test::make_icosphere(1, 3));
  EXPECT_FALSE(bvh.closest_point(Vec3(3, 0, 0), 1.9));
  EXPECT_TRUE(bvh.closest_point(Vec3(3, 0, 0), 2.1));
  EXPECT_FALSE(bvh.closest_point(Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0)));
}

TEST(Bvh, SignMatchesTheWindingNumberOnCrumpledBalls) {
  for (unsigned seed = 10; seed < 16; ++seed)
    expect_signs_of_winding(make_crumpled_ball(seed), seed + 100);
}

TEST(Bvh, SignMatchesTheWindingNumberAtSpikesEdgesAndCaps) {
  expect_signs_of_winding(test::make_spike(0.05, 1.5, 5), 1);
  expect_signs_of_winding(test::make_spike(1.0, 0.02, 9), 2);
  TriangleMesh capped = test::make_box(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  for (Index t = 0; t < 12; ++t)
    for (int side = 0; side < 3; ++side) capped = test::with_cap(capped, t, side);
  expect_signs_of_winding(capped, 3);
}

TEST(Bvh, FaceNormalsAloneGiveWrongSigns) {
  // Ensures that the two tests above contain points where only pseudonormals are right.
  const TriangleMesh mesh = test::make_spike(0.05, 1.5, 5);
  const Bvh bvh(mesh);
  int wrong = 0;
  for (const Vec3& p : hard_points(mesh, 1)) {
    const SignedDistance d = bvh.signed_distance(p);
    const Vec3 n = face_normal(mesh, d.nearest.triangle);
    if ((n.dot(p - d.nearest.point) < 0.0) != (d.distance_mm < 0.0)) ++wrong;
  }
  EXPECT_GT(wrong, 10);
}

TEST(Bvh, DistanceToASphereMatchesTheFormula) {
  const Bvh bvh(test::make_icosphere(10, 5));
  std::mt19937 random(8);
  for (int n = 0; n < 200; ++n) {
    const Vec3 p = random_point(random, 15);
    // Chords of 0.4 mm lie up to 0.4^2 / (8 * 10) = 0.002 mm inside the sphere.
    EXPECT_NEAR(bvh.signed_distance(p).distance_mm, p.norm() - 10.0, 0.004);
  }
}

TEST(Bvh, RaysHitTheNearSideFirst) {
  const Bvh bvh(test::make_box(Vec3(-1, -1, -1), Vec3(1, 1, 1)));
  const auto hit = bvh.first_hit(Vec3(0.2, 0.3, 5), Vec3(0, 0, -2));
  ASSERT_TRUE(hit);
  EXPECT_DOUBLE_EQ(hit->distance_mm, 4.0);
  EXPECT_FALSE(bvh.first_hit(Vec3(0.2, 0.3, 5), Vec3(0, 0, 1)));
  EXPECT_FALSE(bvh.first_hit(Vec3(1.2, 0.3, 5), Vec3(0, 0, -1)));
  EXPECT_EQ(bvh.count_hits(Vec3(0.2, 0.3, 5), Vec3(0, 0, -1)), 2);
}

TEST(Bvh, OddHitsMeanInside) {
  const TriangleMesh mesh = make_crumpled_ball(21);
  const Bvh bvh(mesh);
  std::mt19937 random(22);
  for (int n = 0; n < 500; ++n) {
    const Vec3 p = random_point(random, 1.5);
    const bool inside = bvh.count_hits(p, Vec3(0.3, 0.5, 0.8)) % 2 == 1;
    EXPECT_EQ(inside, bvh.signed_distance(p).distance_mm < 0.0);
  }
}

TEST(Bvh, AcceptsHundredsOfEqualTriangles) {
  TriangleMesh heap;
  heap.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  heap.triangles.assign(1000, {0, 1, 2});
  const auto found = Bvh(heap).closest_point(Vec3(0.2, 0.2, 1.0));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->triangle, 0);
  EXPECT_EQ(found->distance_mm, 1.0);
}

}  // namespace
}  // namespace lefort::geometry::test_bvh
