#include <lefort/core/parallel.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/smooth_surface.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/shapes.h"

namespace lefort::geometry::test_smooth_surface {
namespace {

TriangleMesh rough_sphere() {
  TriangleMesh sphere = test::make_icosphere(30.0, 5);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> step_mm(-0.3, 0.3);
  for (Vec3& v : sphere.vertices) v *= 1.0 + step_mm(random) / 30.0;
  return sphere;
}

double roughness_mm(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const Vec3& v : mesh.vertices) sum += (v.norm() - 30.0) * (v.norm() - 30.0);
  return std::sqrt(sum / double(mesh.vertices.size()));
}

TEST(SmoothSurface, RemovesRoughnessAndKeepsTheVolume) {
  const TriangleMesh rough = rough_sphere();
  const TriangleMesh smooth = smooth_surface(rough, {.passes = 10});
  EXPECT_LT(roughness_mm(smooth), 0.35 * roughness_mm(rough));
  EXPECT_NEAR(signed_volume_mm3(smooth), signed_volume_mm3(test::make_icosphere(30.0, 5)),
              1e-3 * signed_volume_mm3(rough));
  EXPECT_EQ(smooth.triangles, rough.triangles);
}

/// Averaging alone would reduce the volume by 2 %.
TEST(SmoothSurface, DoesNotShrinkSmoothSurfaces) {
  const TriangleMesh sphere = test::make_icosphere(30.0, 4);
  const TriangleMesh smooth = smooth_surface(sphere, {.passes = 50});
  EXPECT_NEAR(signed_volume_mm3(smooth) / signed_volume_mm3(sphere), 1.0, 2e-3);
}

TEST(SmoothSurface, NoVertexMovesFurtherThanTheLimit) {
  const TriangleMesh box = test::make_box({0, 0, 0}, {10, 10, 1});
  const TriangleMesh smooth = smooth_surface(box, {.passes = 100, .max_mm = 0.2});
  double furthest_mm = 0.0;
  for (std::size_t v = 0; v < box.vertices.size(); ++v)
    furthest_mm = std::max(furthest_mm, (smooth.vertices[v] - box.vertices[v]).norm());
  EXPECT_LE(furthest_mm, 0.2 + 1e-12);
  EXPECT_GT(furthest_mm, 0.19);
}

TEST(SmoothSurface, BoundaryEdgesDoNotMove) {
  TriangleMesh sheet = test::make_sheet(10.0, 10);
  for (Vec3& v : sheet.vertices) v.z() = 0.3 * std::sin(7.0 * v.x() + 3.0 * v.y());
  const TriangleMesh smooth = smooth_surface(sheet);
  for (std::size_t v = 0; v < sheet.vertices.size(); ++v) {
    if (sheet.vertices[v].head<2>().cwiseAbs().maxCoeff() > 4.9) {
      EXPECT_EQ(smooth.vertices[v], sheet.vertices[v]);
    }
  }
  EXPECT_EQ(smooth_surface(sheet, {.passes = 0}).vertices, sheet.vertices);
}

TEST(SmoothSurface, SameBitsForAnyNumberOfThreads) {
  const auto with = [](int threads) {
    const ThreadLimit limit(threads);
    return smooth_surface(rough_sphere()).vertices;
  };
  EXPECT_EQ(with(1), with(2));
}

}  // namespace
}  // namespace lefort::geometry::test_smooth_surface
