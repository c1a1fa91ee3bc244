#include <lefort/core/check.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/shapes.h"

namespace lefort::field::test_distance_field {
namespace {

using geometry::TriangleMesh;

constexpr double kRadius = 20.0;

DistanceField build_ball(FieldMethod method) {
  return build_distance_field(test::make_icosphere(kRadius, 6), {.method = method,
                                                                 .resolution = 128,
                                                                 .band_mm = 3.0,
                                                                 .tolerance_mm = 0.002,
                                                                 .smooth = true})
      .value();
}

/// A ball of 20 mm with 80,000 triangles and cells of 0.36 mm. Edges are up to 0.42 mm long, so
/// facets lie up to 0.42^2 / 3 / (2 * 20) = 0.0015 mm inside the sphere. The octree has the larger
/// error, so most tests use it.
const DistanceField& ball() {
  static const DistanceField field = build_ball(FieldMethod::kHybrid);
  return field;
}

/// The same in bricks.
const DistanceField& ball_of_bricks() {
  static const DistanceField field = build_ball(FieldMethod::kBricks);
  return field;
}

constexpr double kFacetError = 0.0015;

std::vector<Vec3> points_in_shell(double inner, double outer, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(-1, 1), radius(inner, outer);
  std::vector<Vec3> points;
  while (int(points.size()) < count) {
    const Vec3 p(in(random), in(random), in(random));
    if (p.norm() > 0.1) points.push_back(radius(random) * p.normalized());
  }
  return points;
}

TEST(DistanceField, OfABallMatchesTheFormula) {
  // Trilinear: cell^2 / 8 * (2 / radius) = 0.002 mm at the surface, 0.005 mm with the tolerance.
  ASSERT_GT(ball().guaranteed_mm(), 2.37);
  for (const DistanceField* field : {&ball(), &ball_of_bricks()})
    for (const Vec3& p : points_in_shell(kRadius - 2.37, kRadius + 2.37, 5000, 1)) {
      const FieldSample sample = field->sample(p);
      ASSERT_EQ(sample.zone, Zone::kBand);
      EXPECT_NEAR(sample.distance_mm, p.norm() - kRadius, 0.006);
      EXPECT_LT((sample.gradient_B - p.normalized()).norm(), 0.04);
      EXPECT_NEAR((*field->nearest_point(p) - kRadius * p.normalized()).norm(), 0.0, 0.1);
    }
}

TEST(DistanceField, SmoothOfABallMatchesTheFormula) {
  for (const Vec3& p : points_in_shell(17.1, 22.9, 5000, 2)) {
    const SmoothSample sample = ball().sample_smooth(p);
    ASSERT_EQ(sample.zone, Zone::kBand);
    EXPECT_NEAR(sample.distance_mm, p.norm() - kRadius, kFacetError);
    EXPECT_LT((sample.gradient_B - p.normalized()).norm(), 0.008);
  }
}

TEST(DistanceField, CurvatureOfABallIsOneOverItsRadius) {
  // Facets as large as cells cause scatter of single values, but not of their mean.
  double bias = 0.0;
  const std::vector<Vec3> points = points_in_shell(20.5, 22.5, 2000, 3);
  for (const Vec3& p : points) {
    const Mat3 hessian = ball().sample_smooth(p).hessian_B;
    const Vec3 n = p.normalized();
    const Mat3 expected = (Mat3::Identity() - n * n.transpose()) / p.norm();
    EXPECT_LT((hessian - expected).norm(), 0.06);  // The max is 0.058, the RMS 0.016.
    bias += (hessian - expected).trace() / double(points.size());
  }
  EXPECT_NEAR(bias, 0.0, 0.001);
}

TEST(DistanceField, OfATorusMatchesTheFormula) {
  const auto field =
      build_distance_field(test::make_torus(20, 8, 240, 120), {.resolution = 128, .smooth = true});
  ASSERT_TRUE(field);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi), off(-1, 1);
  for (int n = 0; n < 5000; ++n) {
    const double u = angle(random), v = angle(random), d = off(random);
    const double r = 20 + (8 + d) * std::cos(v);
    const Vec3 p(r * std::cos(u), r * std::sin(u), (8 + d) * std::sin(v));
    EXPECT_NEAR(field->sample(p).distance_mm, d, 0.015);
    EXPECT_NEAR(field->sample_smooth(p).distance_mm, d, 0.012);
  }
}

TEST(DistanceField, OfABoxIsExactAboveItsFaces) {
  const auto field = build_distance_field(test::make_box(Vec3(-10, -10, -10), Vec3(10, 10, 10)),
                                          {.resolution = 64, .smooth = true});
  ASSERT_TRUE(field);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> across(-7, 7), off(-0.9, 0.9);
  for (int n = 0; n < 3000; ++n) {
    Vec3 p(across(random), across(random), across(random));
    const double d = off(random);
    p[n % 3] = 10 + d;
    EXPECT_NEAR(field->sample(p).distance_mm, d, 1e-5);
    EXPECT_NEAR(field->sample_smooth(p).distance_mm, d, 1e-5);
    EXPECT_LT((field->sample(p).gradient_B - Vec3::Unit(n % 3)).norm(), 1e-4);
    EXPECT_LT((*field->nearest_point(p) - (p - d * Vec3::Unit(n % 3))).norm(), 1e-3);
  }
}

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

TEST(DistanceField, EveryPointWithinTheGuaranteedDistanceHasADistance) {
  // Also at corners, edges and tips, where prisms over triangles leave gaps.
  for (const TriangleMesh& mesh :
       {test::make_spike(2, 20, 4), test::make_box(Vec3(-9, -2, -5), Vec3(9, 3, 4))})
    for (const FieldMethod method : kMethods) {
      const auto field = build_distance_field(
          mesh, {.method = method, .resolution = 32, .tolerance_mm = 0.0, .smooth = true});
      ASSERT_TRUE(field);
      const geometry::Bvh bvh(mesh);
      std::mt19937 random(6);
      std::uniform_real_distribution<double> in(-1, 1);
      const Box3 box = field->box_B();
      // Smooth values have errors up to half a cell on the ridges of the distance, and cover the
      // whole band.
      for (int n = 0; n < 10'000; ++n) {
        const Vec3 p =
            box.center() + 0.5 * box.sizes().cwiseProduct(Vec3(in(random), in(random), in(random)));
        if (bvh.closest_point(p, field->guaranteed_mm())) {
          EXPECT_EQ(field->sample(p).zone, Zone::kBand);
        }
        if (bvh.closest_point(p, field->band_mm() - 0.5 * field->cell_mm())) {
          EXPECT_EQ(field->sample_smooth(p).zone, Zone::kBand);
        }
      }
    }
}

TEST(DistanceField, NoCellThatTheGuaranteedDistanceTouchesIsLeftOut) {
  // The narrowest band extends into cells between their corners, most of all around tips.
  std::mt19937 random(12);
  std::uniform_real_distribution<double> in(-1, 1);
  for (int n = 0; n < 20; ++n) {
    const RigidTransform turn(
        Eigen::AngleAxisd(3 * in(random), Vec3(in(random), in(random), in(random)).normalized()));
    const TriangleMesh mesh = test::moved(test::make_spike(4, 4 + in(random), 3), turn);
    const double width = geometry::bounding_box(mesh).sizes().maxCoeff();
    const auto field = build_distance_field(mesh, {.method = kMethods[n % 4],
                                                   .resolution = 32,
                                                   .band_mm = width / (32 - 4.001) * 2,
                                                   .tolerance_mm = 0.0});
    ASSERT_TRUE(field) << field.error().message;
    const geometry::Bvh bvh(mesh);
    for (int cell = 0; cell < 32 * 32 * 32; ++cell) {
      const LatticePoint at = {cell % 32, cell / 32 % 32, cell / 1024};
      if (zone_of(field->cell(at).corners) == Zone::kBand) continue;
      const Vec3 low = field->box_B().min() + field->cell_mm() * Vec3(at[0], at[1], at[2]);
      for (int side = 0; side < 6; ++side) {
        const Vec3 on_face = Vec3::Constant(0.5) + (side % 2 - 0.5) * Vec3(Vec3::Unit(side / 2));
        EXPECT_FALSE(bvh.closest_point(low + field->cell_mm() * on_face,
                                       field->guaranteed_mm() * (1 - 1e-9)));
      }
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 at_corner(corner & 1, corner >> 1 & 1, corner >> 2);
        EXPECT_FALSE(bvh.closest_point(low + field->cell_mm() * at_corner,
                                       field->guaranteed_mm() * (1 - 1e-9)));
      }
    }
  }
}

TEST(DistanceField, OutsideTheBandThereIsOnlyAZone) {
  for (const auto& [p, zone, distance] : {std::tuple(Vec3(0, 0, 0), Zone::kInside, -3.0),
                                          std::tuple(Vec3(16.5, 0, 0), Zone::kInside, -3.0),
                                          std::tuple(Vec3(0, -22.99, 5), Zone::kOutside, 3.0),
                                          std::tuple(Vec3(15, 15, 15), Zone::kOutside, 3.0),
                                          std::tuple(Vec3(1e9, 0, 0), Zone::kOutside, 3.0)}) {
    const FieldSample sample = ball().sample(p);
    EXPECT_EQ(sample.zone, zone) << p.transpose();
    EXPECT_EQ(sample.distance_mm, distance);
    EXPECT_TRUE(sample.gradient_B.isZero(0.0));
    const SmoothSample smooth = ball().sample_smooth(p);
    EXPECT_EQ(smooth.zone, zone);
    EXPECT_EQ(smooth.distance_mm, distance);
    EXPECT_TRUE(smooth.gradient_B.isZero(0.0) && smooth.hessian_B.isZero(0.0));
  }
}

TEST(DistanceField, GrowsUpToTheBandAndIsConstantBeyond) {
  double previous = -4.0;
  for (double r = 15.0; r < 25.0; r += 0.01) {
    const Vec3 p = r * Vec3(0.36, 0.48, 0.8);
    const SmoothSample sample = ball().sample_smooth(p);
    const double beyond = std::abs(r - kRadius) - 3.0;
    if (std::abs(beyond) > kFacetError) {
      EXPECT_EQ(sample.zone == Zone::kBand, beyond < 0.0) << r;
    }
    EXPECT_GE(sample.distance_mm, previous - kFacetError);
    EXPECT_LT(std::abs(sample.distance_mm), 3.0 + 1e-12);
    previous = sample.distance_mm;
  }
}

TEST(DistanceField, PointsThatAreNotFiniteAreUnknown) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vec3& p : {Vec3(nan, 0, 0), Vec3(20, nan, 0), Vec3(0, 0, infinity)}) {
    EXPECT_EQ(ball().sample(p).zone, Zone::kUnknown);
    EXPECT_EQ(ball().sample_smooth(p).zone, Zone::kUnknown);
    EXPECT_EQ(ball().sample(p).distance_mm, 3.0);
  }
}

TEST(DistanceField, GradientOfACellIsTheDerivativeOfItsValue) {
  // Queries are in single precision, so the step is long. Along an axis a cell is linear, so
  // differences are exact up to 2 * 2^-24 * 3 mm, over a step of 0.036 mm.
  for (const DistanceField* field : {&ball(), &ball_of_bricks()}) {
    const double step = 0.05 * field->cell_mm();
    int compared = 0;
    for (const Vec3& p : points_in_shell(17.7, 22.3, 1000, 7)) {
      const FieldSample sample = field->sample(p);
      const Vec3 u = (p - field->box_B().min()) / field->cell_mm();
      for (int k = 0; k < 3; ++k) {
        // The gradient may change within a step over the face of a cell.
        if (std::abs(u[k] - std::round(u[k])) < 0.051) continue;
        const double up = field->sample(p + step * Vec3::Unit(k)).distance_mm;
        const double down = field->sample(p - step * Vec3::Unit(k)).distance_mm;
        EXPECT_NEAR((up - down) / (2 * step), sample.gradient_B[k], 2e-5);
        ++compared;
      }
    }
    EXPECT_GT(compared, 2000);
  }
}

TEST(DistanceField, SmoothDerivativesMatchTheValue) {
  constexpr double kStep = 1e-4;
  const FieldFrame& frame = ball().frame();
  int compared = 0;
  for (const Vec3& p : points_in_shell(17.5, 22.5, 500, 8)) {
    const SmoothSample sample = ball().sample_smooth(p);
    const Vec3 u = (p - frame.origin_B) / frame.cell_mm;
    for (int k = 0; k < 3; ++k) {
      // The second derivative may jump at the face of a cell.
      if (std::abs(u[k] - std::round(u[k])) < 2.0 * kStep / frame.cell_mm) continue;
      ++compared;
      const SmoothSample up = ball().sample_smooth(p + kStep * Vec3::Unit(k));
      const SmoothSample down = ball().sample_smooth(p - kStep * Vec3::Unit(k));
      EXPECT_NEAR(sample.gradient_B[k], (up.distance_mm - down.distance_mm) / (2 * kStep), 1e-6);
      EXPECT_LT((sample.hessian_B.col(k) - (up.gradient_B - down.gradient_B) / (2 * kStep)).norm(),
                1e-4);
    }
  }
  EXPECT_GT(compared, 1450);
}

TEST(DistanceField, SmoothIsDifferentiableWhereOctreeCellsOfDifferentSizeMeet) {
  // A box: large octree cells above its faces, finest ones along its edges.
  const auto field = build_distance_field(
      test::make_box(Vec3(-10, -10, -10), Vec3(10, 10, 10)),
      {.method = FieldMethod::kHybrid, .resolution = 64, .tolerance_mm = 0.01, .smooth = true});
  ASSERT_TRUE(field);
  const FieldFrame& frame = field->frame();
  std::mt19937 random(9);
  int between_sizes = 0;
  for (int n = 0; n < 20'000; ++n) {
    LatticePoint cell{};
    for (int& c : cell) c = int(1 + random() % 63);
    LatticePoint other = cell;
    --other[std::size_t(n % 3)];
    const CellSamples a = field->cell(cell), b = field->cell(other);
    if (zone_of(a.corners) != Zone::kBand || zone_of(b.corners) != Zone::kBand) continue;
    const Vec3 in_face = Vec3(0.3, 0.6, 0.4) - Vec3(0.3, 0.6, 0.4)[n % 3] * Vec3::Unit(n % 3);
    const Vec3 p = frame.origin_B + frame.cell_mm * (Vec3(cell[0], cell[1], cell[2]) + in_face);
    const Vec3 step = 1e-9 * Vec3::Unit(n % 3);
    const SmoothSample before = field->sample_smooth(p - step);
    const SmoothSample after = field->sample_smooth(p + step);
    if (before.zone != Zone::kBand || after.zone != Zone::kBand) continue;
    if (a.cells != b.cells) ++between_sizes;
    EXPECT_NEAR(before.distance_mm, after.distance_mm, 1e-8);
    EXPECT_LT((before.gradient_B - after.gradient_B).norm(), 1e-7);
  }
  EXPECT_GT(between_sizes, 50);
}

TEST(DistanceField, JumpsBetweenOctreeCellsStayWithinTwiceTheTolerance) {
  const FieldFrame& frame = ball().frame();
  for (const DistanceField* field : {&ball(), &ball_of_bricks()}) {
    const double maximum = (field == &ball() ? 2.0 * frame.tolerance_mm : 0.0) + 1e-6;
    std::mt19937 random(10);
    int within = 0;
    for (int n = 0; n < 20'000; ++n) {
      Vec3 u(double(random() % 128), double(random() % 128), double(random() % 128));
      for (int k = 0; k < 3; ++k)
        if (k != n % 3) u[k] += double(random() % 100) / 100.0;
      const Vec3 p = frame.origin_B + frame.cell_mm * u;
      const Vec3 step = 1e-10 * Vec3::Unit(n % 3);
      const FieldSample before = field->sample(p - step), after = field->sample(p + step);
      if (before.zone == Zone::kBand && after.zone == Zone::kBand) {
        EXPECT_NEAR(before.distance_mm, after.distance_mm, maximum);
        ++within;
      } else if (before.zone == Zone::kBand || after.zone == Zone::kBand) {
        // At the edge of the band: not closer than the guaranteed distance.
        const FieldSample& known = before.zone == Zone::kBand ? before : after;
        EXPECT_GE(std::abs(known.distance_mm), field->guaranteed_mm() - 0.006);
      } else {
        EXPECT_EQ(before.zone, after.zone);
      }
    }
    EXPECT_GT(within, 1000);
  }
}

TEST(DistanceField, HasNoClosestPointOutsideTheBand) {
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(15, 15, 15), Vec3(1e9, 0, 0),
                        Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0)})
    EXPECT_FALSE(ball().nearest_point(p)) << p.transpose();
}

TEST(DistanceField, CountsTheMemoryOfItsParts) {
  const Octree& octree = std::get<Octree>(ball().samples());
  EXPECT_GT(octree.band_leaf_count(), 1000);
  EXPECT_EQ(ball().sample_bytes(), octree.bytes());
  EXPECT_GT(ball().sample_bytes(), octree.samples().size_bytes());
  EXPECT_GT(ball().smooth_bytes(), 1000U);
  EXPECT_EQ(ball().smooth_bytes(), ball().smooth_lattice()->bytes());
  const auto plain = build_distance_field(test::make_icosphere(5, 2), {.resolution = 16});
  EXPECT_FALSE(plain->is_smooth());
  EXPECT_EQ(plain->smooth_bytes(), 0U);
  EXPECT_THROW(static_cast<void>(plain->sample_smooth(Vec3::Zero())), LogicError);
}

}  // namespace
}  // namespace lefort::field::test_distance_field
