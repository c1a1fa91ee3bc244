#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/query/lattice_samples.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "field/brute_force.h"
#include "support/shapes.h"
#include "support/ugly_mesh.h"

namespace lefort::field::test_lattice_samples {
namespace {

using geometry::TriangleMesh;

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

DistanceField build(const TriangleMesh& mesh, FieldMethod method, double tolerance_mm = 0.0,
                    int resolution = 32) {
  return build_distance_field(
             mesh, {.method = method, .resolution = resolution, .tolerance_mm = tolerance_mm})
      .value();
}

/// All samples by lattice point.
std::map<LatticePoint, float> samples_of(const DistanceField& field) {
  std::map<LatticePoint, float> samples;
  const LatticeWindow all = window_of(field.frame(), std::nullopt, 1).value();
  EXPECT_TRUE(for_each_block(field, all, Progress::none(), [&](const SampleBlock& block) {
    for (int place = 0; place < SparseLattice::kBrickPoints; ++place) {
      const LatticePoint p = {block.first[0] + place % 8, block.first[1] + place / 8 % 8,
                              block.first[2] + place / 64};
      if (all.find(p)) samples[p] = block.at(p);
    }
  }));
  const auto n = std::size_t(field.frame().resolution) + 1;
  EXPECT_EQ(samples.size(), n * n * n);
  return samples;
}

bool same(float a, float b, double tolerance) {
  if (std::isfinite(a) && std::isfinite(b)) return std::abs(double(a) - double(b)) <= tolerance;
  return a == b || (std::isnan(a) && std::isnan(b));
}

TEST(LatticeSamples, MatchQueries) {
  for (const FieldMethod method : kMethods) {
    const DistanceField field = build(test::make_torus(8, 3, 40, 20), method, 0.01);
    int in_band = 0;
    for (const auto& [p, value] : samples_of(field)) {
      const FieldSample found = field.sample(test::position_of(field.frame(), p[0], p[1], p[2]));
      if (found.zone != Zone::kBand) continue;
      ++in_band;
      // Adjacent cells of different size differ by the tolerance.
      ASSERT_NEAR(
          double(value), found.distance_mm,
          method == FieldMethod::kUniform || method == FieldMethod::kBricks ? 1e-6 : 0.02 + 1e-6);
    }
    EXPECT_GT(in_band, 1000);
  }
}

TEST(LatticeSamples, AreTheDistancesInAnyFormat) {
  for (const auto& mesh : {test::make_torus(8, 3, 40, 20), test::make_crumpled_ball(3, 6, 14)}) {
    const geometry::Bvh bvh(mesh);
    for (const FieldMethod method : kMethods)
      for (const double tolerance_mm : {0.0, 0.05}) {
        const DistanceField field = build(mesh, method, tolerance_mm);
        const double maximum =
            field.band_mm() / (1 << 23) + test::kFloatError_mm +
            (std::holds_alternative<Octree>(field.samples()) ? tolerance_mm : 0.0);
        Index far = 0;
        for (const auto& [p, value] : samples_of(field)) {
          const double exact =
              bvh.signed_distance(test::position_of(field.frame(), p[0], p[1], p[2])).distance_mm;
          if (std::isfinite(value)) {
            ASSERT_NEAR(double(value), exact, maximum);
          } else {
            ASSERT_FALSE(std::isnan(value));
            ASSERT_EQ(value < 0.0F, exact < 0.0);
            // Samples at the edge of the band that no leaf of an octree uses are omitted.
            const double minimum = std::holds_alternative<Octree>(field.samples())
                                       ? field.guaranteed_mm()
                                       : field.band_mm() - test::kFloatError_mm;
            ASSERT_GE(std::abs(exact), minimum);
            ++far;
          }
        }
        EXPECT_GT(far, 1000);
      }
  }
}

TEST(LatticeSamples, ConflictsAreUnknownInAnyFormat) {
  int in_conflict = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const TriangleMesh mesh = test::make_ugly_mesh(random);
    const auto bricks = build_distance_field(mesh, {.resolution = 16});
    if (!bricks) continue;
    const auto uniform =
        build_distance_field(mesh, {.method = FieldMethod::kUniform, .resolution = 16}).value();
    const double slack = 4e-6 * bricks->band_mm();
    const auto in_bricks = samples_of(*bricks), in_uniform = samples_of(uniform);
    for (const auto& [p, value] : in_bricks) {
      const float dense = in_uniform.at(p);
      // Rounding decides which samples are in the band and which are in conflict.
      const auto at_edge = [&](float d) {
        return std::abs(double(std::abs(d)) - bricks->band_mm()) < slack;
      };
      if (at_edge(value) || at_edge(dense)) continue;
      // Conflicts across faces of bricks are found after those in bricks: one of the two samples
      // may already be unknown, and the other remains.
      const auto at_face = [](int c) { return c % 8 == 0 || c % 8 == 7; };
      if (std::isfinite(value) && std::isnan(dense) && std::any_of(p.begin(), p.end(), at_face))
        continue;
      const LatticePoint low = {std::min(p[0], 15), std::min(p[1], 15), std::min(p[2], 15)};
      in_conflict += std::isnan(value) && std::isfinite(uniform.cell(low).corners[0]) ? 1 : 0;
      ASSERT_TRUE(same(value, dense, slack)) << value << ", expected " << dense;
    }
  }
  EXPECT_GT(in_conflict, 100);
}

TEST(LatticeSamples, OfAnOpenSurfaceAreUnknownBeyondTheBand) {
  for (const FieldMethod method : kMethods) {
    const SampleCount count = count_samples(build(test::make_sheet(20, 4), method)).value();
    EXPECT_EQ(count.outside + count.inside, 0);
    EXPECT_GT(count.known, 1000);
    EXPECT_GT(count.unknown, 1000);
  }
}

TEST(LatticeSamples, CountsMatchTheVolumes) {
  // A box of 20 x 16 x 12 mm in a cube of 64 cells of 1 mm, a band of 3 mm.
  const TriangleMesh box = test::make_box(Vec3(-10, -8, -6), Vec3(10, 8, 6));
  for (const FieldMethod method : kMethods) {
    const DistanceField field = build_distance_field(box, {.method = method,
                                                           .resolution = 64,
                                                           .band_mm = 3.0,
                                                           .tolerance_mm = 0.0,
                                                           .side_mm = 64.0})
                                    .value();
    const SampleCount count = count_samples(field).value();
    EXPECT_EQ(count.total(), 65 * 65 * 65);
    EXPECT_EQ(count.unknown, 0);
    // Lattice points at depths of 3 mm or more.
    const bool is_octree = std::holds_alternative<Octree>(field.samples());
    if (!is_octree) {
      EXPECT_EQ(count.inside, 15 * 11 * 7) << int(method);
    } else {
      EXPECT_GE(count.inside, 15 * 11 * 7) << int(method);
      EXPECT_LE(count.inside, 17 * 13 * 9) << int(method);
    }
  }
}

TEST(LatticeSamples, AWindowIsEveryNthSampleOfABox) {
  FieldFrame frame;
  frame.origin_B = Vec3(-10, 20, 0);
  frame.cell_mm = 0.5;
  frame.resolution = 64;
  const LatticeWindow all = window_of(frame, std::nullopt, 1).value();
  EXPECT_EQ(all.first, (LatticePoint{0, 0, 0}));
  EXPECT_EQ(all.count, (LatticePoint{65, 65, 65}));
  EXPECT_EQ(all.size(), 65 * 65 * 65);

  // Limits that coincide with samples include them; limits beyond the field are clamped.
  const LatticeWindow part =
      window_of(frame, Box3(Vec3(-9.5, 21.2, 30.0), Vec3(-8.0, 23.9, 99.0)), 1).value();
  EXPECT_EQ(part.first, (LatticePoint{1, 3, 60}));
  EXPECT_EQ(part.count, (LatticePoint{4, 5, 5}));
  EXPECT_EQ(part.find({4, 7, 64}), (LatticePoint{3, 4, 4}));
  EXPECT_FALSE(part.find({0, 7, 64}));
  EXPECT_FALSE(part.find({5, 7, 64}));

  const LatticeWindow third = window_of(frame, std::nullopt, 3).value();
  EXPECT_EQ(third.count, (LatticePoint{22, 22, 22}));
  EXPECT_EQ(third.find({6, 0, 63}), (LatticePoint{2, 0, 21}));
  EXPECT_FALSE(third.find({7, 0, 63}));
  // A region does not change which samples are selected.
  EXPECT_EQ(window_of(frame, Box3(Vec3(-9.5, 20, 0), Vec3(5, 30, 9)), 3)->first,
            (LatticePoint{3, 0, 0}));
}

TEST(LatticeSamples, AWindowWithoutSamplesIsRejected) {
  FieldFrame frame;
  frame.cell_mm = 0.5;
  frame.resolution = 64;
  const auto refused = [&](const std::optional<Box3>& region, int every) {
    const auto window = window_of(frame, region, every);
    return !window && window.error().code == ErrorCode::kInvalidArgument;
  };
  EXPECT_TRUE(refused(std::nullopt, 0));
  EXPECT_TRUE(refused(std::nullopt, 65));
  EXPECT_TRUE(refused(Box3(Vec3(-9, 0, 0), Vec3(-1, 5, 5)), 1));
  EXPECT_TRUE(refused(Box3(Vec3(0.6, 0, 0), Vec3(0.9, 5, 5)), 1));  // Between two samples.
  EXPECT_TRUE(refused(Box3(Vec3(0.5, 0, 0), Vec3(0.5, 5, 5)), 2));
  EXPECT_TRUE(refused(Box3(Vec3::Constant(std::nan("")), Vec3::Constant(5)), 1));
}

/// Stops immediately.
struct Impatient : Progress {
  [[nodiscard]] bool stop_requested() const override { return true; }
};

TEST(LatticeSamples, ReadingCanBeStopped) {
  Impatient impatient;
  const auto count = count_samples(build(test::make_icosphere(9, 2), kMethods[0]), impatient);
  ASSERT_FALSE(count);
  EXPECT_EQ(count.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::field::test_lattice_samples
