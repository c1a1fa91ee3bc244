#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/query/lattice_samples.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "field/brute_force.h"
#include "support/shapes.h"
#include "support/ugly_mesh.h"

namespace lefort::field::test_field_methods {
namespace {

using geometry::TriangleMesh;

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

struct Shape {
  std::string name;
  TriangleMesh mesh;
};

/// Closed, without self-intersections.
std::vector<Shape> solid_shapes() {
  return {{"torus", test::make_torus(8, 3, 40, 20)},
          {"box", test::make_box(Vec3(-9, -7, -5), Vec3(9, 8, 4))},
          {"capped box", test::make_capped_box(Vec3(-9, -7, -5), Vec3(9, 8, 4))},
          {"plate", test::make_box(Vec3(-10, -10, 0), Vec3(10, 10, 0.1))},
          {"spike", test::make_spike(2, 20, 5)},
          {"crumpled ball", test::make_crumpled_ball(3, 6, 14)},
          {"hollow ball", test::join(test::make_icosphere(10, 3),
                                     test::turn_inside_out(test::make_icosphere(7, 3)))}};
}

DistanceField build(const TriangleMesh& mesh, FieldMethod method, double tolerance_mm,
                    int resolution = 32) {
  return build_distance_field(
             mesh, {.method = method, .resolution = resolution, .tolerance_mm = tolerance_mm})
      .value();
}

std::vector<Vec3> points_in_box(const DistanceField& field, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(-0.02, 1.02);
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n)
    points.push_back(field.box_B().min() +
                     field.box_B().sizes().cwiseProduct(Vec3(in(random), in(random), in(random))));
  return points;
}

/// True if a sample around `p` is at the edge of the band, where rounding decides.
bool at_edge_of_band(const DistanceField& field, const geometry::Bvh& bvh, const Vec3& p) {
  const Vec3 u = (p - field.frame().origin_B) / field.cell_mm();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at(std::floor(u.x()) + (corner & 1), std::floor(u.y()) + (corner >> 1 & 1),
                  std::floor(u.z()) + (corner >> 2));
    const double d = bvh.closest_point(field.frame().origin_B + field.cell_mm() * at)->distance_mm;
    if (std::abs(d - field.band_mm()) < test::kFloatError_mm) return true;
  }
  return false;
}

TEST(FieldMethods, GiveTheSameZonesAndDistances) {
  for (const auto& [name, mesh] : solid_shapes())
    for (const double tolerance_mm : {0.0, 0.005, 0.05, 0.5}) {
      SCOPED_TRACE(name);
      const geometry::Bvh bvh(mesh);
      const DistanceField uniform = build(mesh, FieldMethod::kUniform, tolerance_mm);
      const std::vector<Vec3> points = points_in_box(uniform, 3000, 1);
      for (const FieldMethod method :
           {FieldMethod::kBricks, FieldMethod::kHybrid, FieldMethod::kAdaptive}) {
        const DistanceField field = build(mesh, method, tolerance_mm);
        ASSERT_EQ(field.frame().origin_B, uniform.frame().origin_B);
        // A tolerance at the samples also holds between them: both methods are trilinear there.
        // Bricks have no tolerance; they round to 2^-23 of the band.
        const double maximum = method == FieldMethod::kBricks ? field.band_mm() / (1 << 23) + 1e-6
                                                              : tolerance_mm + test::kFloatError_mm;
        for (const Vec3& p : points) {
          const FieldSample a = uniform.sample(p), b = field.sample(p);
          if (a.zone != b.zone) {
            ASSERT_TRUE(at_edge_of_band(field, bvh, p))
                << "method " << int(method) << ": " << int(b.zone) << ", expected " << int(a.zone);
          } else {
            ASSERT_NEAR(a.distance_mm, b.distance_mm, maximum) << "method " << int(method);
          }
        }
      }
    }
}

TEST(FieldMethods, OctreesMeetTheToleranceAtEverySample) {
  for (const auto& [name, mesh] : solid_shapes()) {
    SCOPED_TRACE(name);
    for (const double tolerance_mm : {0.0, 0.003, 0.03, 0.3})
      for (const FieldMethod method : {FieldMethod::kHybrid, FieldMethod::kAdaptive})
        EXPECT_LE(test::max_error_at_samples(build(mesh, method, tolerance_mm, 16), mesh),
                  tolerance_mm + test::kFloatError_mm);
  }
}

TEST(FieldMethods, BricksAndUniformStoreEverySample) {
  for (const auto& [name, mesh] : solid_shapes()) {
    SCOPED_TRACE(name);
    for (const FieldMethod method : {FieldMethod::kBricks, FieldMethod::kUniform}) {
      // The tolerance applies to octrees only.
      const DistanceField field = build(mesh, method, 1.0);
      EXPECT_LE(test::max_error_at_samples(field, mesh),
                field.band_mm() / (1 << 23) + test::kFloatError_mm);
    }
  }
}

TEST(FieldMethods, BricksMatchTheSamplesOfTheUniformFieldUpToRounding) {
  for (const auto& [name, mesh] : solid_shapes()) {
    SCOPED_TRACE(name);
    const DistanceField uniform = build(mesh, FieldMethod::kUniform, 0.0);
    const DistanceField bricks = build(mesh, FieldMethod::kBricks, 0.0);
    const double maximum = uniform.band_mm() / (1 << 23) + 1e-6;
    for (int c = 0; c < 32 * 32 * 32; ++c) {
      const LatticePoint low = {c % 32, c / 32 % 32, c / 1024};
      const CellSamples a = uniform.cell(low), b = bricks.cell(low);
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const double exact = double(a.corners[corner]), kept = double(b.corners[corner]);
        if (std::isfinite(exact) && std::isfinite(kept)) {
          ASSERT_NEAR(kept, exact, maximum);
        } else if (std::isfinite(exact) || std::isfinite(kept)) {
          // Rounding moved it out of the band.
          const double known = std::isfinite(exact) ? exact : kept;
          ASSERT_NEAR(std::abs(known), uniform.band_mm(), maximum);
          ASSERT_EQ(std::signbit(exact), std::signbit(kept));
        } else {
          ASSERT_EQ(exact, kept);
        }
      }
    }
  }
}

TEST(FieldMethods, HaveDistancesUpToTheGuaranteedDistance) {
  for (const auto& [name, mesh] : solid_shapes()) {
    SCOPED_TRACE(name);
    const geometry::Bvh bvh(mesh);
    for (const FieldMethod method : kMethods)
      for (const double tolerance_mm : {0.0, 0.1}) {
        const DistanceField field = build(mesh, method, tolerance_mm);
        EXPECT_DOUBLE_EQ(field.guaranteed_mm(), field.band_mm() - std::sqrt(3.0) * field.cell_mm());
        for (const Vec3& p : points_in_box(field, 5000, 2)) {
          const double distance = bvh.closest_point(p)->distance_mm;
          const Zone zone = field.sample(p).zone;
          if (distance < field.guaranteed_mm()) {
            ASSERT_EQ(zone, Zone::kBand) << int(method);
          }
          if (distance > field.band_mm() + field.cell_mm()) {
            ASSERT_NE(zone, Zone::kBand) << int(method);
          }
        }
      }
  }
}

TEST(FieldMethods, ASampleExactlyAtTheEdgeOfTheBandIsOutsideItForAll) {
  // Faces on samples, and lengths whose squares are exact in floats: samples two cells from a face
  // are exactly 4 mm away.
  const TriangleMesh box = test::make_box(Vec3(-8, -8, -8), Vec3(8, 8, 8));
  for (const FieldMethod method : kMethods) {
    SCOPED_TRACE(int(method));
    const DistanceField field = build_distance_field(box, {.method = method,
                                                           .resolution = 32,
                                                           .band_mm = 4.0,
                                                           .tolerance_mm = 0.0,
                                                           .side_mm = 64.0})
                                    .value();
    ASSERT_EQ(field.cell_mm(), 2.0);
    const LatticeWindow all = window_of(field.frame(), std::nullopt, 1).value();
    Index at_edge = 0;
    ASSERT_TRUE(for_each_block(field, all, Progress::none(), [&](const SampleBlock& block) {
      for (int place = 0; place < SparseLattice::kBrickPoints; ++place) {
        const LatticePoint p = {block.first[0] + place % 8, block.first[1] + place / 8 % 8,
                                block.first[2] + place / 64};
        if (!all.find(p)) continue;
        const Vec3 from_middle = test::position_of(field.frame(), p[0], p[1], p[2]).cwiseAbs();
        const Vec3 out = (from_middle - Vec3::Constant(8.0)).cwiseMax(0.0);
        const double distance = out.norm() > 0.0 ? out.norm() : 8.0 - from_middle.maxCoeff();
        // Next to an edge or corner of the box rounding decides.
        if (distance == 4.0 && std::count(out.begin(), out.end(), 0.0) == 2 &&
            std::count(from_middle.begin(), from_middle.end(), 8.0) > 0)
          continue;
        at_edge += distance == 4.0 ? 1 : 0;
        ASSERT_EQ(std::isfinite(block.at(p)), distance < 4.0) << p[0] << ' ' << p[1] << ' ' << p[2];
      }
    }));
    EXPECT_GT(at_edge, 200);
  }
}

TEST(FieldMethods, ZonesOutsideTheBandMatchTheWindingNumber) {
  // Nested shells: outside, inside, outside, inside towards the center.
  const TriangleMesh shells = test::join(
      test::join(test::make_icosphere(29, 2), test::turn_inside_out(test::make_icosphere(20, 2))),
      test::make_icosphere(11, 2));
  for (const auto& [name, mesh] :
       {Shape{"shells", shells}, Shape{"ball", test::make_crumpled_ball(4, 6, 14)}})
    for (const FieldMethod method : kMethods) {
      const DistanceField field =
          build_distance_field(mesh, {.method = method, .resolution = 64, .side_mm = 80}).value();
      int far = 0;
      for (const Vec3& p : points_in_box(field, 5000, 3)) {
        const FieldSample sample = field.sample(p);
        if (sample.zone == Zone::kBand) continue;
        ++far;
        ASSERT_EQ(sample.zone,
                  geometry::winding_number(mesh, p) > 0.5 ? Zone::kInside : Zone::kOutside)
            << name << ", method " << int(method) << " at " << p.transpose();
      }
      EXPECT_GT(far, 1000);
    }
}

TEST(FieldMethods, AreTheSameForSmoothSamples) {
  // The spline has its own lattice, independent of the format of the samples.
  const TriangleMesh torus = test::make_torus(20, 8, 60, 30);
  const auto smooth = [&](FieldMethod method) {
    return build_distance_field(torus, {.method = method, .resolution = 32, .smooth = true})
        .value();
  };
  const DistanceField uniform = smooth(FieldMethod::kUniform);
  for (const FieldMethod method :
       {FieldMethod::kBricks, FieldMethod::kHybrid, FieldMethod::kAdaptive}) {
    const DistanceField field = smooth(method);
    for (const Vec3& p : points_in_box(field, 2000, 5)) {
      const SmoothSample a = uniform.sample_smooth(p), b = field.sample_smooth(p);
      ASSERT_EQ(a.zone, b.zone);
      ASSERT_EQ(a.distance_mm, b.distance_mm);
      ASSERT_EQ(a.hessian_B, b.hessian_B);
    }
  }
}

}  // namespace
}  // namespace lefort::field::test_field_methods
