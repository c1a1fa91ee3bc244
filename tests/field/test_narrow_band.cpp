#include <lefort/field/narrow_band.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_measures.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/shapes.h"

namespace lefort::field {
namespace {

using geometry::TriangleMesh;

constexpr double kReachCells = 7.0;

FieldFrame frame_around(const TriangleMesh& mesh, int resolution) {
  const Box3 box = geometry::bounding_box(mesh);
  FieldFrame frame;
  frame.resolution = resolution;
  frame.cell_mm = box.sizes().maxCoeff() / (resolution - 8);
  frame.origin_B = box.center() - Vec3::Constant(0.5 * frame.cell_mm * resolution);
  return frame;
}

/// Compares every point of the lattice, inside the cube and around it, with a search that shares
/// nothing with the sampler but the pseudonormals; and the sign with the winding number.
void expect_exact_everywhere(const TriangleMesh& mesh, int resolution, bool closed) {
  const FieldFrame frame = frame_around(mesh, resolution);
  const double reach = kReachCells * frame.cell_mm;
  const auto sampled = sample_narrow_band(mesh, frame, reach, Progress::none());
  ASSERT_TRUE(sampled);
  const geometry::Bvh bvh(mesh);
  int within = 0;
  for (int k = -3; k <= resolution + 3; ++k)
    for (int j = -3; j <= resolution + 3; ++j)
      for (int i = -3; i <= resolution + 3; ++i) {
        const Vec3 p = frame.origin_B + frame.cell_mm * Vec3(i, j, k);
        const float found = sampled->at({i, j, k}, kFar);
        const double distance = bvh.signed_distance(p).distance_mm;
        if (std::abs(distance) > reach * (1 + 1e-6)) {
          ASSERT_TRUE(std::isnan(found)) << p.transpose();
          continue;
        }
        if (std::abs(distance) > reach * (1 - 1e-6)) continue;
        ++within;
        ASSERT_NEAR(std::abs(found), std::abs(distance), 1e-6 * frame.cell_mm * resolution)
            << "at " << i << ' ' << j << ' ' << k;
        if (!closed || std::abs(distance) < 1e-7) continue;
        ASSERT_EQ(found<0.0F, test::winding_number(mesh, p)> 0.5) << p.transpose();
      }
  EXPECT_GT(within, 1000);
}

TriangleMesh make_crumpled_ball(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(6, 14);
  TriangleMesh ball = test::make_icosphere(1.0, 2);
  for (Vec3& v : ball.vertices) v *= radius(random);
  return ball;
}

TEST(NarrowBand, IsExactAroundABox) {
  // Convex edges and corners: most of the band there lies in no triangle's prism.
  expect_exact_everywhere(test::make_box(Vec3(-9, -7, -5), Vec3(9, 8, 4)), 32, true);
}

TEST(NarrowBand, IsExactOnLatticePointsThatLieOnFacesEdgesAndCorners) {
  // extent / (resolution - 8) = 1 mm: the box coincides with lattice planes.
  expect_exact_everywhere(test::make_box(Vec3(0, 0, 0), Vec3(24, 24, 24)), 32, true);
}

TEST(NarrowBand, IsExactAroundCrumpledBalls) {
  for (unsigned seed = 1; seed < 4; ++seed)
    expect_exact_everywhere(make_crumpled_ball(seed), 32, true);
}

TEST(NarrowBand, IsExactAroundSpikesAndNeedles) {
  expect_exact_everywhere(test::make_spike(1.0, 20, 5), 32, true);
  expect_exact_everywhere(test::make_spike(10, 0.2, 40), 32, true);
}

TEST(NarrowBand, IsExactWhereThePlateIsThinnerThanACell) {
  expect_exact_everywhere(test::make_box(Vec3(-10, -10, 0), Vec3(10, 10, 0.1)), 32, true);
}

TEST(NarrowBand, IsExactAroundTrianglesWithoutArea) {
  TriangleMesh capped = test::make_box(Vec3(-9, -7, -5), Vec3(9, 8, 4));
  for (Index t = 0; t < 12; ++t)
    for (int side = 0; side < 3; ++side) capped = test::with_cap(capped, t, side);
  expect_exact_everywhere(capped, 32, true);
}

TEST(NarrowBand, IsExactAroundAnOpenSheet) {
  expect_exact_everywhere(test::make_sheet(20, 3), 32, false);
}

TEST(NarrowBand, IsExactAroundAHeapOfTriangles) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> in(-10, 10);
  TriangleMesh heap;
  for (std::int32_t n = 0; n < 90; ++n)
    heap.vertices.emplace_back(in(random), in(random), in(random));
  for (std::int32_t n = 0; n < 90; n += 3) heap.triangles.push_back({n, n + 1, n + 2});
  expect_exact_everywhere(heap, 32, false);
}

TEST(NarrowBand, RefusesABandThatDoesNotFitInMemory) {
  const TriangleMesh ball = test::make_icosphere(50, 3);
  const FieldFrame frame = frame_around(ball, 1024);
  const auto huge = sample_narrow_band(ball, frame, 250 * frame.cell_mm, Progress::none());
  EXPECT_EQ(huge.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::field
