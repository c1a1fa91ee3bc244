#include <lefort/geometry/closest_point.h>

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace lefort::geometry::test_closest_point {
namespace {

using Corners = std::array<Vec3, 3>;

Vec3 random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> in(-size, size);
  return {in(random), in(random), in(random)};
}

TrianglePoint closest(const Vec3& p, const Corners& t) {
  return closest_point_on_triangle(p, t[0], t[1], t[2]);
}

/// c is the point of a convex set closest to p exactly if no corner lies beyond the plane through c
/// normal to (p - c). This needs no second implementation for comparison.
void expect_nearest(const Vec3& p, const Corners& t, double scale) {
  const TrianglePoint found = closest(p, t);
  ASSERT_TRUE(found.point.allFinite());
  const Vec3 r = p - found.point;
  EXPECT_NEAR(found.squared_distance_mm2, r.squaredNorm(), 1e-9 * scale * scale);
  for (const Vec3& corner : t) EXPECT_LE(r.dot(corner - found.point), 1e-7 * scale * scale);

  const auto k = std::size_t(number_of(found.feature));
  if (is_vertex(found.feature)) {
    EXPECT_EQ(found.point, t[k]);
  } else if (is_edge(found.feature)) {
    const Vec3 from = t[k], to = t[(k + 1) % 3];
    EXPECT_NEAR((found.point - from).norm() + (to - found.point).norm(), (to - from).norm(),
                1e-9 * scale);
  } else {
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    EXPECT_NEAR(n.normalized().dot(found.point - t[0]), 0.0, 1e-7 * scale);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 edge = t[(i + 1) % 3] - t[i];
      EXPECT_GE(n.cross(edge).normalized().dot(found.point - t[i]), -1e-7 * scale);
    }
  }
}

TEST(ClosestPoint, IsOptimalForRandomTriangles) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20'000; ++trial) {
    const Corners t = {random_vector(random, 1), random_vector(random, 1),
                       random_vector(random, 1)};
    expect_nearest(random_vector(random, 2), t, 2.0);
  }
}

TEST(ClosestPoint, IsOptimalForSliversCapsAndNeedlesFarFromTheOrigin) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> exponent(-12.0, 0.0), along(-0.5, 1.5);
  for (int trial = 0; trial < 20'000; ++trial) {
    const Vec3 a = random_vector(random, 100), edge = random_vector(random, 1);
    const double thin = std::pow(10.0, exponent(random));
    const Corners t = {a, a + edge, a + along(random) * edge + random_vector(random, thin)};
    expect_nearest(a + random_vector(random, 2), t, 4.0);
  }
}

TEST(ClosestPoint, ReturnsEachOfTheSevenRegions) {
  const Corners t = {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  const auto feature_at = [&](double x, double y) { return closest(Vec3(x, y, 3), t).feature; };
  EXPECT_EQ(feature_at(1, 1), Feature::kFace);
  EXPECT_EQ(feature_at(2, -1), Feature::kEdge0);
  EXPECT_EQ(feature_at(3, 3), Feature::kEdge1);
  EXPECT_EQ(feature_at(-1, 2), Feature::kEdge2);
  EXPECT_EQ(feature_at(-1, -1), Feature::kVertex0);
  EXPECT_EQ(feature_at(6, -1), Feature::kVertex1);
  EXPECT_EQ(feature_at(-1, 6), Feature::kVertex2);
  EXPECT_DOUBLE_EQ(closest(Vec3(1, 1, 3), t).squared_distance_mm2, 9.0);
  EXPECT_DOUBLE_EQ(closest(Vec3(3, 3, 3), t).squared_distance_mm2, 11.0);
}

TEST(ClosestPoint, HandlesObtuseTriangles) {
  // Outside edge 0 and beyond its end, but closest to the interior of edge 2.
  const Corners t = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(-10, 1, 0)};
  const TrianglePoint found = closest(Vec3(-5, -1, 0), t);
  EXPECT_EQ(found.feature, Feature::kEdge2);
  EXPECT_NEAR(found.point.dot(Vec3(1, 10, 0)), 0.0, 1e-12);
}

TEST(ClosestPoint, OnAnEdgeOrCornerTheDistanceIsZero) {
  const Corners t = {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  for (const Vec3& p : {Vec3(2, 0, 0), Vec3(0, 0, 0), Vec3(2, 2, 0), Vec3(1, 1, 0)})
    EXPECT_EQ(closest(p, t).squared_distance_mm2, 0.0);
}

TEST(ClosestPoint, TrianglesWithoutAreaAreTheirEdges) {
  const Vec3 p(1, 2, 0);
  const TrianglePoint cap = closest(p, {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(1.5, 0, 0)});
  EXPECT_EQ(cap.point, Vec3(1, 0, 0));
  EXPECT_TRUE(is_edge(cap.feature));
  const TrianglePoint needle = closest(p, {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(3, 0, 0)});
  EXPECT_EQ(needle.point, Vec3(1, 0, 0));
  const TrianglePoint dot = closest(p, {Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 0)});
  EXPECT_EQ(dot.squared_distance_mm2, 4.0);
  EXPECT_TRUE(is_vertex(dot.feature));
}

TEST(ClosestPoint, DegenerateMeansLowNotSmall) {
  EXPECT_FALSE(triangle_is_degenerate(Vec3(0, 0, 0), Vec3(1e-9, 0, 0), Vec3(0, 1e-9, 0)));
  EXPECT_TRUE(triangle_is_degenerate(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0.9e-7, 0)));
  EXPECT_FALSE(triangle_is_degenerate(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 1.1e-7, 0)));
}

}  // namespace
}  // namespace lefort::geometry::test_closest_point
