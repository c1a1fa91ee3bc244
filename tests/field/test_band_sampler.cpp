#include <lefort/field/build/band_sampler.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "field/brute_force.h"
#include "support/shapes.h"
#include "support/ugly_mesh.h"

namespace lefort::field::test_band_sampler {
namespace {

using geometry::TriangleMesh;

/// A narrow band, sampled by binned triangles only, and a wide one that a tree completes.
constexpr std::array kBands_cells = {5.0, 9.0};
/// Error of the search in single precision, on surfaces of about 20 mm.
constexpr double kFloatError_mm = 2e-5;

FieldFrame frame_around(const TriangleMesh& mesh, int resolution) {
  const Box3 box = geometry::bounding_box(mesh);
  FieldFrame frame;
  frame.resolution = resolution;
  frame.cell_mm = box.sizes().maxCoeff() / (resolution - 8);
  frame.origin_B = box.center() - Vec3::Constant(0.5 * frame.cell_mm * resolution);
  return frame;
}

/// Compares every lattice point, inside the cube and around it, with a search that uses the same
/// pseudonormals but nothing else of the sampler; and the sign with the winding number.
void expect_exact_within(double band_cells, const TriangleMesh& mesh, int resolution, bool closed) {
  const FieldFrame frame = frame_around(mesh, resolution);
  const double band_mm = band_cells * frame.cell_mm;
  const PreparedSurface surface = prepare_surface(mesh).value();
  ASSERT_EQ(surface.closed, closed);
  const auto sampled = sample_narrow_band(surface, frame, band_mm, nullptr, Progress::none());
  ASSERT_TRUE(sampled);
  const geometry::Bvh bvh(mesh);
  int within = 0;
  for (int k = -3; k <= resolution + 3; ++k)
    for (int j = -3; j <= resolution + 3; ++j)
      for (int i = -3; i <= resolution + 3; ++i) {
        const Vec3 p = test::position_of(frame, i, j, k);
        const float found = sampled->at({i, j, k}, kUnsampled);
        const double distance = bvh.closest_point(p)->distance_mm;
        if (distance > band_mm * (1 + 1e-6)) {
          ASSERT_TRUE(std::isnan(found)) << p.transpose();
          continue;
        }
        if (distance > band_mm * (1 - 1e-6)) continue;
        ++within;
        ASSERT_NEAR(std::abs(found), distance, kFloatError_mm)
            << "at " << i << ' ' << j << ' ' << k;
        if (!closed || distance < 1e-7) continue;
        ASSERT_EQ(found<0.0F, geometry::winding_number(mesh, p)> 0.5) << p.transpose();
      }
  EXPECT_GT(within, 1000);
}

void expect_exact_everywhere(const TriangleMesh& mesh, int resolution, bool closed) {
  for (const double band_cells : kBands_cells) {
    SCOPED_TRACE(band_cells);
    expect_exact_within(band_cells, mesh, resolution, closed);
  }
}

TEST(BandSampler, IsExactAroundABox) {
  // Convex edges and corners: most of the band there lies in no prism of a triangle.
  expect_exact_everywhere(test::make_box(Vec3(-9, -7, -5), Vec3(9, 8, 4)), 32, true);
}

TEST(BandSampler, IsExactOnLatticePointsThatLieOnFacesEdgesAndCorners) {
  // extent / (resolution - 8) = 1 mm: the box coincides with lattice planes.
  expect_exact_everywhere(test::make_box(Vec3(0, 0, 0), Vec3(24, 24, 24)), 32, true);
}

TEST(BandSampler, IsExactAroundCrumpledBalls) {
  for (unsigned seed = 1; seed < 4; ++seed)
    expect_exact_everywhere(test::make_crumpled_ball(seed, 6, 14), 32, true);
}

TEST(BandSampler, IsExactAroundSpikesAndNeedles) {
  expect_exact_everywhere(test::make_spike(1.0, 20, 5), 32, true);
  expect_exact_everywhere(test::make_spike(10, 0.2, 40), 32, true);
}

TEST(BandSampler, IsExactWhereThePlateIsThinnerThanACell) {
  expect_exact_everywhere(test::make_box(Vec3(-10, -10, 0), Vec3(10, 10, 0.1)), 32, true);
}

TEST(BandSampler, IsExactAroundTrianglesWithoutArea) {
  expect_exact_everywhere(test::make_capped_box(Vec3(-9, -7, -5), Vec3(9, 8, 4)), 32, true);
}

TEST(BandSampler, IsExactAroundATorus) {
  expect_exact_everywhere(test::make_torus(8, 3, 24, 12), 32, true);
}

TEST(BandSampler, IsExactAroundAnOpenSheet) {
  expect_exact_everywhere(test::make_sheet(20, 3), 32, false);
}

TEST(BandSampler, IsExactAroundATriangleSoup) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> in(-10, 10);
  TriangleMesh heap;
  for (std::int32_t n = 0; n < 90; ++n)
    heap.vertices.emplace_back(in(random), in(random), in(random));
  for (std::int32_t n = 0; n < 90; n += 3) heap.triangles.push_back({n, n + 1, n + 2});
  expect_exact_everywhere(heap, 32, false);
}

/// The result of the sampler, brick by brick.
std::vector<float> samples_with(const PreparedSurface& surface, const FieldFrame& frame,
                                double band_cells, Simd simd) {
  const BandSampler sampler = BandSampler::create(surface, frame, band_cells * frame.cell_mm,
                                                  BandSampler::kMaxPoints, Progress::none(), simd)
                                  .value();
  std::vector<float> samples(sampler.bricks().size() * SparseLattice::kBrickPoints);
  for (std::size_t slot = 0; slot < sampler.bricks().size(); ++slot)
    static_cast<void>(sampler.sample(
        Index(slot),
        std::span<float, SparseLattice::kBrickPoints>(
            samples.data() + slot * SparseLattice::kBrickPoints, SparseLattice::kBrickPoints)));
  return samples;
}

TEST(BandSampler, EveryProcessorGivesTheSameBits) {
  std::mt19937 random(21);
  std::vector<TriangleMesh> meshes = {test::make_torus(8, 3, 24, 12), test::make_spike(10, 0.2, 40),
                                      test::make_capped_box(Vec3(-9, -7, -5), Vec3(9, 8, 4)),
                                      test::make_crumpled_ball(1, 6, 14)};
  for (int n = 0; n < 20; ++n) meshes.push_back(test::make_soup(random));
  for (const TriangleMesh& mesh : meshes) {
    const FieldFrame frame = frame_around(mesh, 32);
    const PreparedSurface surface = prepare_surface(mesh).value();
    for (const double band_cells : kBands_cells) {
      const std::vector<float> baseline = samples_with(surface, frame, band_cells, Simd::kBaseline);
      for (const Simd simd : {Simd::kAvx2, Simd::kAvx512}) {
        if (simd > best_simd()) continue;
        const std::vector<float> samples = samples_with(surface, frame, band_cells, simd);
        ASSERT_EQ(samples.size(), baseline.size());
        EXPECT_EQ(std::memcmp(samples.data(), baseline.data(), baseline.size() * sizeof(float)), 0);
      }
    }
  }
}

TEST(BandSampler, BricksAscendAndContainEverySampleOfTheBand) {
  const TriangleMesh torus = test::make_torus(8, 3, 24, 12);
  const FieldFrame frame = frame_around(torus, 64);
  const PreparedSurface surface = prepare_surface(torus).value();
  for (const double band_cells : {2.0, 8.0, 20.0}) {
    const BandSampler sampler =
        BandSampler::create(surface, frame, band_cells * frame.cell_mm).value();
    EXPECT_TRUE(std::is_sorted(sampler.bricks().begin(), sampler.bricks().end()));
    EXPECT_EQ(std::adjacent_find(sampler.bricks().begin(), sampler.bricks().end()),
              sampler.bricks().end());
    const geometry::Bvh bvh(torus);
    std::mt19937 random(22);
    const SparseLattice lattice(64, {sampler.bricks().begin(), sampler.bricks().end()}, 0.0F);
    for (int n = 0; n < 20'000; ++n) {
      const LatticePoint p = {int(random() % 65), int(random() % 65), int(random() % 65)};
      if (!bvh.closest_point(test::position_of(frame, p[0], p[1], p[2]),
                             (band_cells - 0.001) * frame.cell_mm))
        continue;
      EXPECT_NE(lattice.slot_of(lattice.brick_of(p)), SparseLattice::kNoBrick);
    }
  }
}

TEST(BandSampler, AWiderBandChangesNoSampleOfANarrowOne) {
  // The wide band is sampled differently: near the surface by triangles, beyond by a tree.
  for (unsigned seed = 1; seed < 4; ++seed) {
    const TriangleMesh ball = test::make_crumpled_ball(seed, 6, 14);
    const FieldFrame frame = frame_around(ball, 64);
    const PreparedSurface surface = prepare_surface(ball).value();
    const auto narrow =
        sample_narrow_band(surface, frame, 6 * frame.cell_mm, nullptr, Progress::none());
    const auto wide =
        sample_narrow_band(surface, frame, 14 * frame.cell_mm, nullptr, Progress::none());
    for (int k = 0; k <= 64; ++k)
      for (int j = 0; j <= 64; ++j)
        for (int i = 0; i <= 64; ++i) {
          const float near = narrow->at({i, j, k}, kUnsampled);
          if (!std::isnan(near)) {
            ASSERT_EQ(near, wide->at({i, j, k}, kUnsampled));
          }
        }
  }
}

TEST(BandSampler, IsExactAroundRandomSoups) {
  // Every lattice point, against every triangle: common and repeated corners, opposite duplicates,
  // triangles without area, in all combinations.
  for (unsigned seed = 0; seed < 120; ++seed) {
    std::mt19937 random(seed);
    TriangleMesh soup = test::make_soup(random);
    test::spoil(soup, random);
    SCOPED_TRACE(seed);
    const auto surface = prepare_surface(soup);
    if (!surface) continue;  // Only points and lines.
    const FieldFrame frame = frame_around(surface->mesh_B, 16);
    const double band_mm = (seed % 2 == 0 ? 4.0 : 7.5) * frame.cell_mm;
    const auto sampled = sample_narrow_band(*surface, frame, band_mm, nullptr, Progress::none());
    ASSERT_TRUE(sampled);
    for (int k = 0; k <= 16; ++k)
      for (int j = 0; j <= 16; ++j)
        for (int i = 0; i <= 16; ++i) {
          const double distance =
              test::brute_distance(surface->mesh_B, test::position_of(frame, i, j, k));
          const float found = sampled->at({i, j, k}, kUnsampled);
          if (distance > band_mm * (1 + 1e-6)) {
            ASSERT_TRUE(std::isnan(found));
          }
          if (distance < band_mm * (1 - 1e-6)) {
            ASSERT_NEAR(std::abs(found), distance, kFloatError_mm / 10.0)  // About 2 mm wide.
                << "at " << i << ' ' << j << ' ' << k;
          }
        }
  }
}

TEST(BandSampler, RejectsABandOfMorePointsThanRequested) {
  const TriangleMesh torus = test::make_torus(8, 3, 24, 12);
  const FieldFrame frame = frame_around(torus, 128);
  const PreparedSurface surface = prepare_surface(torus).value();
  for (const double band_cells : {3.0, 20.0}) {
    const auto fits = BandSampler::create(surface, frame, band_cells * frame.cell_mm);
    ASSERT_TRUE(fits);
    const Index points = Index(fits->bricks().size()) * SparseLattice::kBrickPoints;
    EXPECT_TRUE(BandSampler::create(surface, frame, band_cells * frame.cell_mm, points));
    const auto too_many =
        BandSampler::create(surface, frame, band_cells * frame.cell_mm, points - 1);
    ASSERT_FALSE(too_many);
    EXPECT_EQ(too_many.error().code, ErrorCode::kInvalidArgument);
  }
}

TEST(BandSampler, StopsOnRequest) {
  class Stopped : public Progress {
    [[nodiscard]] bool stop_requested() const override { return true; }
  } stopped;
  const TriangleMesh box = test::make_box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const auto sampled = sample_narrow_band(prepare_surface(box).value(), frame_around(box, 16), 0.1,
                                          nullptr, stopped);
  ASSERT_FALSE(sampled);
  EXPECT_EQ(sampled.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::field::test_band_sampler
