#include <lefort/compare/surface_difference.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/mesh_properties.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "support/shapes.h"

namespace lefort::compare::test_surface_difference {
namespace {

using test::make_icosphere;

TEST(SurfaceDifference, BetweenSpheresIsTheDifferenceOfTheirRadii) {
  const geometry::Bvh inner(make_icosphere(10.0, 5));
  const SurfaceDifference outwards = measure_difference(make_icosphere(12.5, 4), inner);
  for (const double d : outwards.signed_mm) EXPECT_NEAR(d, 2.5, 0.01);
  const geometry::Bvh outer(make_icosphere(12.5, 5));
  const SurfaceDifference inwards = measure_difference(make_icosphere(10.0, 4), outer);
  for (const double d : inwards.signed_mm) EXPECT_NEAR(d, -2.5, 0.01);
}

TEST(SurfaceDifference, AreasOfVerticesAddUpToTheSurface) {
  const geometry::TriangleMesh box = test::make_box({0, 0, 0}, {2, 3, 4});
  const std::vector<double> areas_mm2 = vertex_areas(box);
  EXPECT_NEAR(std::accumulate(areas_mm2.begin(), areas_mm2.end(), 0.0), 52.0, 1e-12);
}

/// A sheet of 20 mm under one of 40 mm: points beyond its edge have no counterpart.
TEST(SurfaceDifference, NothingIsComparedBeyondTheOtherSurface) {
  geometry::TriangleMesh large = test::make_sheet(40.0, 40);
  for (Vec3& v : large.vertices) v.z() = 1.0;
  const geometry::Bvh small(test::make_sheet(20.0, 20));
  const SurfaceDifference difference = measure_difference(large, small);
  for (std::size_t v = 0; v < large.vertices.size(); ++v) {
    const double off_mm = large.vertices[v].head<2>().cwiseAbs().maxCoeff();
    // At the edge itself both results are valid.
    if (off_mm < 9.9) {
      EXPECT_NEAR(difference.signed_mm[v], 1.0, 1e-12);
    }
    if (off_mm > 10.1) {
      EXPECT_TRUE(std::isnan(difference.signed_mm[v])) << large.vertices[v].transpose();
    }
  }
}

TEST(SurfaceDifference, DistantAndOppositeSheetsAreNotCompared) {
  geometry::TriangleMesh above = test::make_sheet(10.0, 10);
  for (Vec3& v : above.vertices) v.z() = 3.0;
  const geometry::TriangleMesh below = test::make_sheet(20.0, 20);
  EXPECT_NEAR(measure_difference(above, geometry::Bvh(below), {.max_mm = 3.5}).signed_mm[60], 3.0,
              1e-12);
  EXPECT_TRUE(
      std::isnan(measure_difference(above, geometry::Bvh(below), {.max_mm = 2.5}).signed_mm[60]));
  for (auto& triangle : above.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_TRUE(std::isnan(measure_difference(above, geometry::Bvh(below)).signed_mm[60]));
}

TEST(SurfaceDifference, SameBitsForAnyNumberOfThreads) {
  const geometry::TriangleMesh from = make_icosphere(11.0, 4, {0.3, 0.1, -0.2});
  const geometry::Bvh onto(make_icosphere(10.0, 4));
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return measure_difference(from, onto).signed_mm;
  };
  EXPECT_EQ(with(1), with(2));
}

}  // namespace
}  // namespace lefort::compare::test_surface_difference
