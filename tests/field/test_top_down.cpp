#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/bvh.h>

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "field/brute_force.h"
#include "support/shapes.h"

namespace lefort::field::test_top_down {
namespace {

using geometry::TriangleMesh;

DistanceField build(const TriangleMesh& mesh, double tolerance_mm, int resolution,
                    double band_mm = 0.0) {
  return build_distance_field(mesh, {.method = FieldMethod::kAdaptive,
                                     .resolution = resolution,
                                     .band_mm = band_mm,
                                     .tolerance_mm = tolerance_mm})
      .value();
}

TEST(TopDown, KeepsTheToleranceAtEverySampleOfTheBand) {
  const TriangleMesh torus = test::make_torus(20, 8, 60, 30);
  for (const double tolerance : {0.0, 0.01, 0.1, 1.0})
    EXPECT_LE(test::max_error_at_samples(build(torus, tolerance, 32, 4.0), torus),
              tolerance + test::kFloatError_mm);
}

TEST(TopDown, KeepsTheToleranceAtSharpCorners) {
  const TriangleMesh spike = test::make_spike(3, 40, 4);
  EXPECT_LE(test::max_error_at_samples(build(spike, 0.05, 64), spike), 0.05 + test::kFloatError_mm);
  const TriangleMesh box = test::make_box(Vec3(-20, -9, -5), Vec3(20, 8, 7));
  EXPECT_LE(test::max_error_at_samples(build(box, 0.02, 32), box), 0.02 + test::kFloatError_mm);
}

TEST(TopDown, LargerToleranceNeedsFewerSamples) {
  const TriangleMesh torus = test::make_torus(20, 8, 60, 30);
  std::size_t previous = std::numeric_limits<std::size_t>::max();
  // Two cells of 1 mm have an error of at least 2^2 / 8 / (8 + 4) = 0.04 mm, 4 mm outside of the
  // tube.
  for (const double tolerance : {0.0, 0.06, 0.1, 0.5}) {
    const DistanceField field = build(torus, tolerance, 64, 4.0);
    const std::size_t samples = std::get<Octree>(field.samples()).samples().size();
    EXPECT_LT(samples, previous);
    previous = samples;
  }
}

TEST(TopDown, SpaceBeyondTheBandIsFewLargeLeaves) {
  const DistanceField field = build(test::make_icosphere(27, 3), 0.01, 64);
  EXPECT_GE(field.cell({32, 32, 32}).cells, 8);
  EXPECT_GE(field.cell({0, 0, 0}).cells, 8);
  EXPECT_EQ(zone_of(field.cell({32, 32, 32}).corners), Zone::kInside);
  EXPECT_EQ(zone_of(field.cell({0, 0, 0}).corners), Zone::kOutside);
}

TEST(TopDown, CellsWithSignConflictsAreNotMergedForAnyTolerance) {
  // With a tolerance of several cells interpolation would reproduce +d and -d equally, and give a
  // surface where there is none.
  const TriangleMesh sheet = test::make_sheet(20, 4);
  const DistanceField field = build(sheet, 3.0, 64);
  const geometry::Bvh bvh(sheet);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-9, 9), out(10, 11.5), off(-1, 1);
  for (int n = 0; n < 5000; ++n) {
    const Vec3 p(out(random), along(random), off(random));
    // Lattice points in the plane of the sheet count as above it: the sign conflicts are below
    // them.
    if (p.z() > 0.0 || p.z() < -0.05 || bvh.closest_point(p)->distance_mm < 1.2 * field.cell_mm())
      continue;
    EXPECT_EQ(field.sample(p).zone, Zone::kUnknown) << p.transpose();
  }
}

}  // namespace
}  // namespace lefort::field::test_top_down
