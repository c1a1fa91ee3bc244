#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "field/brute_force.h"
#include "support/shapes.h"

namespace lefort::field::test_crossing_surfaces {
namespace {

using geometry::TriangleMesh;

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

/// Two balls of 20 mm with centers 20 mm apart: part of the surface of each is inside the other.
TriangleMesh two_balls() {
  return test::join(test::make_icosphere(20, 3, Vec3(-10, 0.3, 0.1)),
                    test::make_icosphere(20, 3, Vec3(10, -0.2, 0)));
}

/// At larger distances a cell has no known sample: its zone comes from the winding number, whatever
/// the signs of samples are.
double beyond_all_samples(const DistanceField& field) {
  return field.band_mm() + std::sqrt(3.0) * field.cell_mm();
}

std::vector<Vec3> points_in(const Box3& box, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(0, 1);
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n)
    points.push_back(box.min() +
                     box.sizes().cwiseProduct(Vec3(in(random), in(random), in(random))));
  return points;
}

TEST(CrossingSurfaces, PointsOutsideBothAreOutside) {
  const TriangleMesh mesh = two_balls();
  const geometry::Bvh bvh(mesh);
  for (const FieldMethod method : kMethods) {
    const DistanceField field =
        build_distance_field(mesh, {.method = method, .resolution = 64, .margin_mm = 5}).value();
    ASSERT_TRUE(field.frame().closed);
    int outside = 0;
    for (const Vec3& p : points_in(field.box_B(), 4000, 1)) {
      if (geometry::winding_number(mesh, p) > 0.5) continue;
      const FieldSample sample = field.sample(p);
      ASSERT_NE(sample.zone, Zone::kInside) << p.transpose();
      const double distance = bvh.closest_point(p)->distance_mm;
      if (distance > field.band_mm() + field.cell_mm()) {
        ASSERT_EQ(sample.zone, Zone::kOutside) << p.transpose();
        ++outside;
      }
      // The groove between the balls is sharp: the error of trilinear cells is half a diagonal
      // there.
      if (sample.zone == Zone::kBand) {
        ASSERT_NEAR(sample.distance_mm, distance, 0.87 * field.cell_mm());
      }
    }
    EXPECT_GT(outside, 500);
  }
}

TEST(CrossingSurfaces, NoZoneIsWrongOutsideTheBand) {
  // Inside one ball and outside the other, near the surface of the other, the pseudonormal gives
  // outside. That must remain local.
  const TriangleMesh mesh = two_balls();
  const geometry::Bvh bvh(mesh);
  for (const FieldMethod method : kMethods) {
    const DistanceField field =
        build_distance_field(mesh, {.method = method, .resolution = 64}).value();
    int wrong = 0, far = 0;
    for (const Vec3& p : points_in(field.box_B(), 4000, 2)) {
      const FieldSample sample = field.sample(p);
      if (bvh.closest_point(p)->distance_mm < beyond_all_samples(field)) continue;
      ++far;
      const bool inside = geometry::winding_number(mesh, p) > 0.5;
      wrong += sample.zone == (inside ? Zone::kInside : Zone::kOutside) ? 0 : 1;
    }
    EXPECT_EQ(wrong, 0) << "method " << int(method);
    EXPECT_GT(far, 1000);
  }
}

TEST(CrossingSurfaces, WrongSignsInsideDoNotSpreadToTheOutside) {
  // A crumpled ball that intersects itself in many places.
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> in(-1, 1);
    TriangleMesh mesh = test::make_icosphere(20, 2);
    for (Vec3& v : mesh.vertices) v += 5 * Vec3(in(random), in(random), in(random));
    const geometry::Bvh bvh(mesh);
    for (const FieldMethod method : kMethods) {
      const DistanceField field =
          build_distance_field(mesh, {.method = method, .resolution = 64, .margin_mm = 10}).value();
      for (const Vec3& p : points_in(field.box_B(), 3000, seed)) {
        // Beyond the convex hull of the surface.
        if (p.norm() < 20 + 5 * std::sqrt(3.0) + 1) continue;
        if (bvh.closest_point(p)->distance_mm < beyond_all_samples(field)) continue;
        ASSERT_EQ(field.sample(p).zone, Zone::kOutside)
            << seed << ", method " << int(method) << ": " << p.transpose();
      }
    }
  }
}

TEST(CrossingSurfaces, NoSampleOfTheBandIsInConflictWithAnUnsampledOne) {
  // The surface does not pass between two neighbors if one of them is outside the band. In the
  // intersection of both balls unsampled points are inside; those near the surface of a ball used
  // to be outside.
  const TriangleMesh mesh = two_balls();
  for (const FieldMethod method : {FieldMethod::kBricks, FieldMethod::kUniform}) {
    const DistanceField field =
        build_distance_field(mesh, {.method = method, .resolution = 64, .band_mm = 3.0}).value();
    const int n = field.frame().resolution;
    int beside_far = 0, requested = 0;
    for (int c = 0; c < n * n * n; ++c) {
      const CellSamples cell = field.cell({c % n, c / n % n, c / (n * n)});
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const float d = cell.corners[corner];
        if (!std::isfinite(d)) continue;
        for (std::size_t axis = 1; axis < 8; axis *= 2) {
          const float next = cell.corners[corner ^ axis];
          if (!std::isinf(next)) continue;
          ++beside_far;
          ASSERT_EQ(d < 0, next < 0) << int(method) << ", cell " << c;
        }
      }
      const float d = cell.corners[0];
      if (!std::isfinite(d) || std::abs(d) <= field.cell_mm() || ++requested % 20 != 0) continue;
      const Vec3 p = test::position_of(field.frame(), c % n, c / n % n, c / (n * n));
      ASSERT_EQ(geometry::winding_number(mesh, p) > 0.5, d < 0)
          << int(method) << ": " << p.transpose();
    }
    EXPECT_GT(beside_far, 10'000);
    EXPECT_GT(requested, 10'000);
  }
}

TEST(CrossingSurfaces, NeighborsInConflictAreUnknownAndGiveNoFalseSurface) {
  const TriangleMesh mesh = two_balls();
  const geometry::Bvh bvh(mesh);
  for (const FieldMethod method : kMethods) {
    const DistanceField field =
        build_distance_field(mesh, {.method = method, .resolution = 64, .tolerance_mm = 0.0})
            .value();
    int unknown = 0;
    for (const Vec3& p : points_in(field.box_B(), 40'000, 3)) {
      const FieldSample sample = field.sample(p);
      if (sample.zone == Zone::kUnknown) ++unknown;
      if (sample.zone != Zone::kBand) continue;
      ASSERT_NEAR(std::abs(sample.distance_mm), bvh.closest_point(p)->distance_mm,
                  1.3 * field.cell_mm());
    }
    EXPECT_GT(unknown, 0) << int(method);
  }
}

}  // namespace
}  // namespace lefort::field::test_crossing_surfaces
