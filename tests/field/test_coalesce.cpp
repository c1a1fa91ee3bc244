#include <lefort/field/build_distance_field.h>
#include <lefort/field/coalesce.h>
#include <lefort/field/trilinear.h>
#include <lefort/geometry/bvh.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "support/shapes.h"

namespace lefort::field {
namespace {

using geometry::TriangleMesh;

constexpr float kFloatError = 2e-6F;

DistanceField build(const TriangleMesh& mesh, double tolerance_mm, int resolution = 64) {
  return build_distance_field(
             mesh, {.resolution = resolution, .band_mm = 4.0, .tolerance_mm = tolerance_mm})
      .value();
}

/// Largest error of sample() over every lattice point within the band; and every such point must be
/// in an interpolating cell.
double largest_error_on_lattice(const DistanceField& field, const TriangleMesh& mesh) {
  const geometry::Bvh bvh(mesh);
  const FieldFrame& frame = field.frame();
  double largest = 0.0;
  for (int k = 0; k <= frame.resolution; ++k)
    for (int j = 0; j <= frame.resolution; ++j)
      for (int i = 0; i <= frame.resolution; ++i) {
        const Vec3 p = frame.origin_B + frame.cell_mm * Vec3(i, j, k);
        const double cut_off = frame.band_mm - frame.tolerance_mm - kFloatError;
        if (!bvh.closest_point(p, cut_off)) continue;
        const FieldSample sample = field.sample(p);
        EXPECT_EQ(sample.zone, Zone::kBand) << p.transpose();
        largest =
            std::max(largest, std::abs(sample.distance_mm - bvh.signed_distance(p).distance_mm));
      }
  return largest;
}

TEST(Coalesce, KeepsTheToleranceAtEverySampleOfTheBand) {
  const TriangleMesh torus = test::make_torus(20, 8, 60, 30);
  for (const double tolerance : {0.0, 0.01, 0.1, 1.0})
    EXPECT_LE(largest_error_on_lattice(build(torus, tolerance, 32), torus),
              tolerance + kFloatError);
}

TEST(Coalesce, KeepsTheToleranceAtSharpCorners) {
  const TriangleMesh spike = test::make_spike(3, 40, 4);
  EXPECT_LE(largest_error_on_lattice(build(spike, 0.05), spike), 0.05 + kFloatError);
  const TriangleMesh box = test::make_box(Vec3(-20, -9, -5), Vec3(20, 8, 7));
  EXPECT_LE(largest_error_on_lattice(build(box, 0.02), box), 0.02 + kFloatError);
}

TEST(Coalesce, ErrorsDoNotAddUpFromLevelToLevel) {
  // Along x the samples repeat 0, 1.35, 0.9, 0.45 tolerances. United to two cells they err by 0.9
  // tolerances, and those pairs to four cells by 0.9 again at the corners of the pairs; but the
  // sample at 1 would then err by 1.35.
  FieldFrame frame;
  frame.resolution = 16;
  frame.cell_mm = 1.0;
  frame.band_mm = 4.0;
  frame.tolerance_mm = 0.1;
  frame.closed = true;
  std::vector<std::int32_t> all(5 * 5 * 5);
  std::iota(all.begin(), all.end(), 0);
  SidedDistances distances{SparseLattice(frame.resolution, all, 0.0F),
                           std::vector<Zone>(all.size(), Zone::kOutside)};
  for (std::size_t i = 0; i < distances.near.values().size(); ++i)
    distances.near.values()[i] = 0.1F * std::array{0.0F, 1.35F, 0.9F, 0.45F}[i % 4];
  const auto octree = coalesce(distances, frame, Progress::none());
  ASSERT_TRUE(octree);
  for (int i = 0; i < frame.resolution; ++i) {
    const Octree::Place place = octree->find({i, 3, 5});
    EXPECT_EQ(place.leaf.cells, 2);
    const Vec3 t = Vec3(i - place.leaf.low[0], 0, 0) / place.leaf.cells;
    EXPECT_NEAR(trilinear(place.corners, t), distances.at({i, 3, 5}), frame.tolerance_mm);
  }
}

TEST(Coalesce, LargerToleranceNeedsFewerSamples) {
  const TriangleMesh torus = test::make_torus(20, 8, 60, 30);
  Index previous = std::numeric_limits<Index>::max();
  for (const double tolerance : {0.0, 0.02, 0.1, 0.5}) {
    const FieldStatistics statistics = build(torus, tolerance).statistics();
    EXPECT_LT(statistics.stored_samples, previous);
    previous = statistics.stored_samples;
  }
}

TEST(Coalesce, FlatWallsUniteToCellsAsThickAsTheBand) {
  // Cells of 1 mm, faces on lattice planes that large octree cells respect.
  const TriangleMesh box = test::make_box(Vec3(0, 0, 0), Vec3(56, 56, 56));
  const DistanceField field = build(box, 1e-5);
  ASSERT_DOUBLE_EQ(field.cell_mm(), 1.0);
  EXPECT_GE(field.octree().find({30, 30, 2}).leaf.cells, 4);
  EXPECT_LT(field.statistics().stored_samples, 65 * 65 * 65 / 4);
}

TEST(Coalesce, AClosedSurfaceLeavesNoCellUnknown) {
  for (const TriangleMesh& mesh : {test::make_icosphere(27, 3), test::make_torus(20, 8, 60, 30)})
    EXPECT_EQ(build(mesh, 0.01).octree().count(NodeCode::kUnknown), 0);
}

TEST(Coalesce, SpaceBeyondTheBandIsFewLargeLeaves) {
  const DistanceField field = build(test::make_icosphere(27, 3), 0.01);
  EXPECT_GE(field.octree().find({32, 32, 32}).leaf.cells, 8);
  EXPECT_GE(field.octree().find({0, 0, 0}).leaf.cells, 8);
  EXPECT_EQ(field.octree().find({32, 32, 32}).zone, Zone::kInside);
  EXPECT_EQ(field.octree().find({0, 0, 0}).zone, Zone::kOutside);
}

}  // namespace
}  // namespace lefort::field
