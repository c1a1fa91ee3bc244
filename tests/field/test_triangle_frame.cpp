#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/build/triangle_frame.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "field/brute_force.h"

namespace lefort::field::test_triangle_frame {
namespace {

/// The squared distance, from the formula in triangle_frame.h.
double squared_distance(const TriangleFrame& frame, const Vec3& p) {
  const double w = (p - frame.corners[0]).dot(frame.normal);
  double rim = std::numeric_limits<double>::infinity(), farthest_out = -rim;
  for (std::size_t i = 0; i < 3; ++i) {
    const double q = (p - frame.corners[i]).dot(frame.along[i]),
                 r = (p - frame.corners[i]).dot(frame.outward[i]);
    const double t = std::max({0.0, -q, q - frame.length[i]});
    rim = std::min(rim, r * r + t * t);
    farthest_out = std::max(farthest_out, r);
  }
  return w * w + (frame.has_area && farthest_out <= 0.0 ? 0.0 : rim);
}

void expect_right(const Vec3& a, const Vec3& b, const Vec3& c) {
  const TriangleFrame frame = triangle_frame(a, b, c);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_NEAR(frame.along[i].norm(), 1.0, 1e-12);
    ASSERT_NEAR(frame.outward[i].norm(), 1.0, 1e-12);
    ASSERT_NEAR(frame.along[i].dot(frame.normal), 0.0, 1e-6);
    ASSERT_TRUE(frame.length[i] >= 0.0);
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in(-3, 3);
  for (int n = 0; n < 100; ++n) {
    const Vec3 p(in(random), in(random), in(random));
    ASSERT_NEAR(std::sqrt(squared_distance(frame, p)),
                std::sqrt(geometry::closest_point_on_triangle(p, a, b, c).squared_distance_mm2),
                1e-6);
  }
}

TEST(TriangleFrame, GivesTheDistanceOfAnyTriangle) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> in(-1, 1);
  const auto point = [&] { return Vec3(in(random), in(random), in(random)); };
  for (int n = 0; n < 200; ++n) expect_right(point(), point(), point());
}

TEST(TriangleFrame, GivesTheDistanceOfDegenerateTriangles) {
  const Vec3 a(0.1, 0.2, -0.3), b(1, 0.5, 0.5);
  expect_right(a, b, 0.3 * a + 0.7 * b);  // A line.
  expect_right(a, b, 2.0 * b - a);
  expect_right(a, a, b);  // Two coincident corners: each pair of them.
  expect_right(a, b, a);
  expect_right(b, a, a);
  expect_right(a, a, a);  // A point.
  expect_right(Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
}

TEST(TriangleFrame, GivesTheDistanceWhereSquaresUnderflow) {
  for (const double tiny : {1e-100, 1e-140, 1e-149, 1e-151, 1e-160, 1e-162, 1e-170, 1e-300, 5e-324})
    for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.5, 0, 0)}) {
      SCOPED_TRACE(tiny);
      const Vec3 x(tiny, 0, 0), y(0, tiny, 0);
      expect_right(at, at + x, at + y);
      expect_right(at, at + x, at + 2 * x);
      expect_right(at, at + x, Vec3(1, 1, 1));
    }
}

TEST(TriangleFrame, FieldsAcceptTrianglesTooSmallForTheirDistanceToTheCorner) {
  // A large triangle, and a small one next to it that vanishes in the coordinates of a brick.
  geometry::TriangleMesh mesh;
  mesh.vertices = {{-10, -10, -8}, {10, -10, -8},  {0, 10, -8},
                   {0, 0, 7},      {1e-300, 0, 7}, {0, 1e-300, 7}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  for (const FieldMethod method : {FieldMethod::kBricks, FieldMethod::kHybrid,
                                   FieldMethod::kAdaptive, FieldMethod::kUniform}) {
    const DistanceField field =
        build_distance_field(mesh, {.method = method, .resolution = 32, .tolerance_mm = 0.0})
            .value();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> in(-1, 1);
    for (int n = 0; n < 200; ++n) {
      const Vec3 p = Vec3(0, 0, 7) + 0.8 * field.guaranteed_mm() *
                                         Vec3(in(random), in(random), in(random)).normalized();
      const FieldSample sample = field.sample(p);
      // There may be sign conflicts, as at the boundary of a sheet.
      if (sample.zone == Zone::kUnknown) continue;
      ASSERT_EQ(sample.zone, Zone::kBand) << int(method);
    }
    const LatticePoint near_speck = [&] {
      const Vec3 u = (Vec3(0, 0, 7) - field.frame().origin_B) / field.cell_mm();
      return LatticePoint{int(u.x()), int(u.y()), int(u.z())};
    }();
    float minimum = std::numeric_limits<float>::infinity();
    for (const float d : field.cell(near_speck).corners)
      if (std::isfinite(d)) minimum = std::min(minimum, std::abs(d));
    EXPECT_LE(minimum, std::sqrt(3.0) * field.cell_mm()) << int(method);
  }
}

}  // namespace
}  // namespace lefort::field::test_triangle_frame
