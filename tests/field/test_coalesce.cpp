#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/build/coalesce.h>
#include <lefort/field/query/trilinear.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "field/brute_force.h"
#include "support/shapes.h"

namespace lefort::field::test_coalesce {
namespace {

using geometry::TriangleMesh;

DistanceField build(const TriangleMesh& mesh, double tolerance_mm, int resolution = 64) {
  return build_distance_field(mesh, {.method = FieldMethod::kHybrid,
                                     .resolution = resolution,
                                     .band_mm = 4.0,
                                     .tolerance_mm = tolerance_mm})
      .value();
}

const Octree& octree_of(const DistanceField& field) { return std::get<Octree>(field.samples()); }

TEST(Coalesce, KeepsTheToleranceAtEverySampleOfTheBand) {
  const TriangleMesh torus = test::make_torus(20, 8, 60, 30);
  for (const double tolerance : {0.0, 0.01, 0.1, 1.0})
    EXPECT_LE(test::max_error_at_samples(build(torus, tolerance, 32), torus),
              tolerance + test::kFloatError_mm);
}

TEST(Coalesce, KeepsTheToleranceAtSharpCorners) {
  const TriangleMesh spike = test::make_spike(3, 40, 4);
  EXPECT_LE(test::max_error_at_samples(build(spike, 0.05), spike), 0.05 + test::kFloatError_mm);
  const TriangleMesh box = test::make_box(Vec3(-20, -9, -5), Vec3(20, 8, 7));
  EXPECT_LE(test::max_error_at_samples(build(box, 0.02), box), 0.02 + test::kFloatError_mm);
}

TEST(Coalesce, ErrorsDoNotAddUpFromLevelToLevel) {
  // Along x the samples repeat 0, 1.35, 0.9, 0.45 tolerances. Merged to two cells their errors are
  // 0.9 tolerances, and merging those pairs to four cells gives 0.9 again at the corners of the
  // pairs; but the error of the sample at 1 would be 1.35.
  FieldFrame frame;
  frame.resolution = 16;
  frame.cell_mm = 1.0;
  frame.band_mm = 4.0;
  frame.tolerance_mm = 0.1;
  frame.closed = true;
  std::vector<std::int32_t> all(5 * 5 * 5);
  std::iota(all.begin(), all.end(), 0);
  SignedDistances distances{SparseLattice(frame.resolution, all, 0.0F),
                            std::vector<Zone>(all.size(), Zone::kOutside)};
  for (std::size_t i = 0; i < distances.near.values().size(); ++i)
    distances.near.values()[i] = 0.1F * std::array{0.0F, 1.35F, 0.9F, 0.45F}[i % 4];
  const auto octree = coalesce(distances, frame, Progress::none());
  ASSERT_TRUE(octree);
  for (int i = 0; i < frame.resolution; ++i) {
    const CellSamples cell = octree->cell({i, 3, 5});
    EXPECT_EQ(cell.cells, 2);
    const std::array<float, 3> t = {float(i - cell.low[0]) / 2.0F, 0.5F, 0.5F};
    EXPECT_NEAR(trilinear(cell.corners, t), distances.at({i, 3, 5}), frame.tolerance_mm);
  }
}

TEST(Coalesce, LargerToleranceNeedsFewerSamples) {
  const TriangleMesh torus = test::make_torus(20, 8, 60, 30);
  Index previous = std::numeric_limits<Index>::max();
  // Two cells of 1 mm have an error of at least 2^2 / 8 / (8 + 4) = 0.04 mm, 4 mm outside of the
  // tube.
  for (const double tolerance : {0.0, 0.06, 0.1, 0.5}) {
    const DistanceField field = build(torus, tolerance);
    const auto samples = Index(octree_of(field).samples().size());
    EXPECT_LT(samples, previous);
    previous = samples;
  }
}

TEST(Coalesce, FlatWallsMergeToCellsAsThickAsTheBand) {
  // Cells of 1 mm, faces on lattice planes that large octree cells do not cross.
  const TriangleMesh box = test::make_box(Vec3(0, 0, 0), Vec3(48, 48, 48));
  const DistanceField field = build_distance_field(box, {.method = FieldMethod::kHybrid,
                                                         .resolution = 64,
                                                         .band_mm = 4.01,
                                                         .tolerance_mm = 1e-5,
                                                         .side_mm = 64})
                                  .value();
  ASSERT_DOUBLE_EQ(field.cell_mm(), 1.0);
  EXPECT_GE(field.cell({30, 30, 5}).cells, 4);
  EXPECT_GE(field.cell({30, 30, 10}).cells, 4);
  EXPECT_LT(octree_of(field).samples().size(), 65U * 65 * 65 / 4);
}

int unknown_cells(const DistanceField& field) {
  const int n = field.frame().resolution;
  int unknown = 0;
  for (int c = 0; c < n * n * n; ++c)
    unknown += zone_of(field.cell({c % n, c / n % n, c / (n * n)}).corners) == Zone::kUnknown;
  return unknown;
}

TEST(Coalesce, AClosedSurfaceLeavesNoCellUnknown) {
  for (const TriangleMesh& mesh : {test::make_icosphere(27, 3), test::make_torus(20, 8, 60, 30)})
    EXPECT_EQ(unknown_cells(build(mesh, 0.01)), 0);
}

TEST(Coalesce, SpaceBeyondTheBandIsFewLargeLeaves) {
  const DistanceField field = build(test::make_icosphere(27, 3), 0.01);
  EXPECT_GE(field.cell({32, 32, 32}).cells, 8);
  EXPECT_GE(field.cell({0, 0, 0}).cells, 8);
  EXPECT_EQ(zone_of(field.cell({32, 32, 32}).corners), Zone::kInside);
  EXPECT_EQ(zone_of(field.cell({0, 0, 0}).corners), Zone::kOutside);
}

}  // namespace
}  // namespace lefort::field::test_coalesce
