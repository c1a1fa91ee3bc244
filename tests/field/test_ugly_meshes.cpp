#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/bvh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "field/brute_force.h"
#include "support/ugly_mesh.h"

namespace lefort::field::test_ugly_meshes {
namespace {

using geometry::TriangleMesh;

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

/// The error of a distance interpolated in a cell is at most the mean distance to the corners, with
/// the weights of the interpolation, because each corner differs by at most its distance: half a
/// diagonal. If corners differ in sign, as near inconsistently oriented triangles of a soup, two
/// corners of an edge have distances whose sum is at most a cell, so one has at most half a cell,
/// and the point another diagonal.
double max_error_cells(const CellSamples& cell) {
  const auto inside = [](float d) { return d < 0.0F; };
  const auto count = std::count_if(cell.corners.begin(), cell.corners.end(), inside);
  const double half_diagonal = 0.5 * std::sqrt(3.0);
  return count == 0 || count == 8 ? half_diagonal : 0.51 + 2 * half_diagonal;
}

/// Queries a field of any surface at random points.
void expect_harmless(const DistanceField& field, const TriangleMesh& surface, double slack_mm,
                     std::mt19937& random) {
  std::uniform_real_distribution<double> in(-0.05, 1.05);
  const Box3 box = field.box_B();
  for (int n = 0; n < 200; ++n) {
    const Vec3 p = box.min() + box.sizes().cwiseProduct(Vec3(in(random), in(random), in(random)));
    const FieldSample sample = field.sample(p);
    ASSERT_LE(int(sample.zone), int(Zone::kUnknown));
    ASSERT_TRUE(std::isfinite(sample.distance_mm));
    ASSERT_TRUE(sample.gradient_B.allFinite());
    if (!field.frame().closed) {
      ASSERT_TRUE(sample.zone == Zone::kBand || sample.zone == Zone::kUnknown);
    }
    if (sample.zone != Zone::kBand) continue;
    const CellSamples cell = test::cell_around(field, p);
    for (const float d : cell.corners) ASSERT_LE(double(std::abs(d)), field.band_mm() * (1 + 1e-6));
    ASSERT_NEAR(std::abs(sample.distance_mm), test::brute_distance(surface, p),
                max_error_cells(cell) * cell.cells * field.cell_mm() + slack_mm);
  }
}

TEST(UglyMeshes, AThousandOfThemAreAccepted) {
  int refused = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const TriangleMesh mesh = test::make_ugly_mesh(random);
    const DistanceFieldOptions options{.method = kMethods[seed % 4],
                                       .resolution = 16,
                                       .band_mm = 0.0,
                                       .tolerance_mm = seed % 3 == 0 ? 0.0 : 0.01,
                                       .smooth = seed % 5 == 0};
    const auto field = build_distance_field(mesh, options);
    if (!field) {
      EXPECT_EQ(field.error().code, ErrorCode::kMeshInvalid) << field.error().message;
      ++refused;
      continue;
    }
    // Compare with the surface after collapsed triangles were dropped.
    const TriangleMesh surface = prepare_surface(mesh)->mesh_B;
    expect_harmless(*field, surface, options.tolerance_mm + 1e-5 * field->band_mm(), random);
    if (HasFatalFailure()) return;
    if (!field->is_smooth()) continue;
    std::uniform_real_distribution<double> in(0, 1);
    for (int n = 0; n < 50; ++n) {
      const SmoothSample sample =
          field->sample_smooth(field->box_B().min() + field->box_B().sizes().cwiseProduct(Vec3(
                                                          in(random), in(random), in(random))));
      ASSERT_TRUE(std::isfinite(sample.distance_mm) && sample.gradient_B.allFinite() &&
                  sample.hessian_B.allFinite());
    }
  }
  EXPECT_LT(refused, 50);
}

TEST(UglyMeshes, AllMethodsHaveTheSameKnownSamples) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const TriangleMesh mesh = test::make_ugly_mesh(random);
    const auto uniform =
        build_distance_field(mesh, {.method = FieldMethod::kUniform, .resolution = 16});
    if (!uniform) continue;
    for (const FieldMethod method :
         {FieldMethod::kBricks, FieldMethod::kHybrid, FieldMethod::kAdaptive}) {
      const auto field =
          build_distance_field(mesh, {.method = method, .resolution = 16, .tolerance_mm = 0.0});
      ASSERT_TRUE(field);
      const double slack = 2e-6 * field->band_mm() * 16;
      for (int c = 0; c < 16 * 16 * 16; ++c) {
        const LatticePoint low = {c % 16, c / 16 % 16, c / 256};
        const CellSamples a = uniform->cell(low), b = field->cell(low);
        if (b.cells != 1) continue;
        for (std::size_t corner = 0; corner < 8; ++corner) {
          // Bricks and octrees may have fewer known samples where signs are in conflict, but no
          // different ones.
          if (!std::isfinite(b.corners[corner]) || !std::isfinite(a.corners[corner])) continue;
          ASSERT_NEAR(std::abs(b.corners[corner]), std::abs(a.corners[corner]), slack)
              << "method " << int(method);
        }
      }
    }
  }
}

TEST(UglyMeshes, SoupsAreExactAtEverySampleOfAField) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    TriangleMesh soup = test::make_soup(random);
    test::spoil(soup, random);
    const auto field = build_distance_field(
        soup, {.method = kMethods[seed % 4], .resolution = 16, .tolerance_mm = 0.0});
    if (!field) continue;
    const TriangleMesh surface = prepare_surface(soup)->mesh_B;
    for (int n = 0; n < 1000; ++n) {
      const LatticePoint low = {int(random() % 16), int(random() % 16), int(random() % 16)};
      const CellSamples cell = field->cell(low);
      for (int corner = 0; corner < 8; ++corner) {
        const float d = cell.corners[std::size_t(corner)];
        if (!std::isfinite(d)) continue;
        const Vec3 p = test::position_of(field->frame(), cell.low[0] + cell.cells * (corner & 1),
                                         cell.low[1] + cell.cells * (corner >> 1 & 1),
                                         cell.low[2] + cell.cells * (corner >> 2));
        // About 2 mm wide; the error is proportional to the size.
        ASSERT_NEAR(std::abs(double(d)), test::brute_distance(surface, p), 2e-6);
      }
    }
  }
}

}  // namespace
}  // namespace lefort::field::test_ugly_meshes
