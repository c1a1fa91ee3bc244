#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/query/query_bricks.h>
#include <lefort/field/query/trilinear.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <variant>
#include <vector>

#include "field/brute_force.h"
#include "support/shapes.h"

namespace lefort::field::test_query_bricks {
namespace {

using geometry::TriangleMesh;

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

bool same_bits(const FieldSample& a, const FieldSample& b) {
  bool same = a.zone == b.zone && bits(a.distance_mm) == bits(b.distance_mm);
  for (int k = 0; k < 3; ++k) same = same && bits(a.gradient_B[k]) == bits(b.gradient_B[k]);
  return same;
}

/// Points everywhere: inside the box, on its faces, on lattice planes, very close to them, outside,
/// and points that are not finite.
std::vector<Vec3> all_kinds_of_points(const DistanceField& field, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(-0.1, 1.1);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double odd[] = {
      std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity, 1e300, -1e300, 5e9,
      std::numeric_limits<double>::denorm_min()};
  const Box3 box = field.box_B();
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const double on_plane =
          field.frame().origin_B[k] +
          field.cell_mm() * double(random() % unsigned(field.frame().resolution + 1));
      switch (random() % 12) {
        case 0:
          p[k] = on_plane;
          break;
        case 1:
          p[k] = std::nextafter(on_plane, random() % 2 == 0 ? 1e9 : -1e9);
          break;
        case 2:
          p[k] = random() % 2 == 0 ? box.min()[k] : box.max()[k];
          break;
        case 3:
          p[k] = random() % 6 == 0 ? odd[random() % std::size(odd)] : on_plane;
          break;
        default:
          p[k] = box.min()[k] + in(random)*box.sizes()[k];
      }
    }
    points.push_back(p);
  }
  return points;
}

std::vector<DistanceField> fields_of(const TriangleMesh& mesh) {
  std::vector<DistanceField> fields;
  for (const FieldMethod method : kMethods)
    fields.push_back(build_distance_field(mesh, {.method = method, .resolution = 32}).value());
  return fields;
}

TEST(QueryMany, EveryProcessorGivesTheSameBits) {
  const TriangleMesh torus = test::make_torus(20, 8, 60, 30), sheet = test::make_sheet(20, 4);
  // The last field has more samples than a cache.
  for (const auto& [mesh, resolution] :
       {std::pair(&torus, 32), std::pair(&sheet, 32), std::pair(&torus, 256)}) {
    const DistanceField field = build_distance_field(*mesh, {.resolution = resolution}).value();
    const auto& bricks = std::get<BrickSamples>(field.samples());
    const std::vector<Vec3> points = all_kinds_of_points(field, 4999, 17);
    std::vector<FieldSample> baseline(points.size()), samples(points.size());
    std::vector<float> baseline_mm(points.size()), distances_mm(points.size());
    sample_bricks(bricks, field.frame(), points, baseline, Simd::kBaseline);
    distances_in_bricks(bricks, field.frame(), points, baseline_mm, Simd::kBaseline);
    for (const Simd simd : {Simd::kAvx2, Simd::kAvx512}) {
      if (simd > best_simd()) continue;
      sample_bricks(bricks, field.frame(), points, samples, simd);
      distances_in_bricks(bricks, field.frame(), points, distances_mm, simd);
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_TRUE(same_bits(samples[i], baseline[i])) << points[i].transpose();
        ASSERT_EQ(std::bit_cast<std::uint32_t>(distances_mm[i]),
                  std::bit_cast<std::uint32_t>(baseline_mm[i]))
            << points[i].transpose();
      }
    }
  }
}

/// Layout of the leaves of a field that is constructed by the test.
enum class Leaves { kAll, kOne, kNone };

/// Bricks of 16^3 cells with origin 0, cells of 1 mm, and all kinds of codes, in a buffer that ends
/// with the last leaf. Leaves are in the reverse order of the table, so that the last ones in the
/// buffer are used.
BrickSamples make_by_hand(Leaves leaves, double band_mm, std::mt19937& random) {
  constexpr int kResolution = 16;
  const int side = SparseLattice::bricks_per_side(kResolution);
  std::vector<Brick> bricks(std::size_t(side * side * side));
  std::uint32_t stored = 0;
  for (std::size_t b = bricks.size(); b-- > 0;) {
    bricks[b].inside = std::uint8_t(random());
    bricks[b].unknown = std::uint8_t(random() & random());
    const bool is_last_in_cube = b == std::size_t((2 * side + 2) * side + 2);
    if (leaves == Leaves::kNone || (leaves == Leaves::kOne && !is_last_in_cube)) continue;
    bricks[b].first_leaf = stored;
    bricks[b].stored = leaves == Leaves::kAll ? 0xFF : 0x80;
    stored += std::uint32_t(std::popcount(bricks[b].stored));
  }
  std::vector<std::byte> codes(stored * BrickSamples::kLeafBytes + 1);
  for (std::size_t i = 0; i + 1 < codes.size(); i += BrickSamples::kCodeBytes) {
    const std::int32_t special[] = {BrickSamples::kBeyond,     -BrickSamples::kBeyond,
                                    BrickSamples::kUnknown,    BrickSamples::kBeyond - 1,
                                    1 - BrickSamples::kBeyond, 0};
    const std::int32_t code = random() % 40 == 0 ? special[random() % std::size(special)]
                                                 : std::int32_t(random() % 16'000'000) - 8'000'000;
    BrickSamples::write_code(&codes[i], code);
  }
  return {kResolution, band_mm, std::move(bricks), std::move(codes)};
}

TEST(QueryMany, EveryProcessorReadsConstructedBricksEquallyUpToTheirEdges) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> in(-0.5, 16.5);
  const double odd[] = {0.0,     -0.0,
                        16.0,    std::nextafter(16.0, 17.0),
                        -1e-300, 1e-310,
                        7.0,     8.0,
                        1e300,   std::numeric_limits<double>::quiet_NaN(),
                        15.0,    3.0};
  std::vector<Vec3> points;
  for (int n = 0; n < 40'000; ++n) {
    Vec3 p;
    for (int k = 0; k < 3; ++k)
      p[k] = random() % 4 == 0 ? odd[random() % std::size(odd)] : in(random);
    points.push_back(p);
  }
  for (const Leaves leaves : {Leaves::kAll, Leaves::kOne, Leaves::kNone})
    for (const double band_mm : {3.0, 1e7}) {
      const BrickSamples bricks = make_by_hand(leaves, band_mm, random);
      FieldFrame frame;
      frame.origin_B = Vec3::Zero();
      frame.cell_mm = 1.0;
      frame.resolution = 16;
      frame.band_mm = band_mm;
      frame.closed = true;
      std::vector<float> expected(points.size()), found(points.size());
      distances_in_bricks(bricks, frame, points, expected, Simd::kBaseline);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& p = points[i];
        if (!(p.array() >= 0.0).all() || !(p.array() <= 16.0).all()) {
          ASSERT_FALSE(std::isfinite(expected[i])) << p.transpose();
          continue;
        }
        LatticePoint low{};
        std::array<double, 3> t{};
        for (std::size_t k = 0; k < 3; ++k) {
          low[k] = std::min(int(p[Index(k)]), 15);  // The upper face belongs to the last cell.
          t[k] = p[Index(k)] - low[k];
        }
        const CellSamples cell = bricks.cell(low);
        const bool known =
            std::ranges::all_of(cell.corners, [](float c) { return std::isfinite(c); });
        ASSERT_EQ(std::isfinite(expected[i]), known) << p.transpose();
        std::array<double, 8> corners{};
        std::copy(cell.corners.begin(), cell.corners.end(), corners.begin());
        if (known) {
          ASSERT_NEAR(double(expected[i]), trilinear(corners, t), 1e-6 * band_mm);
        }
      }
      for (const Simd simd : {Simd::kAvx2, Simd::kAvx512}) {
        if (simd > best_simd()) continue;
        for (const std::size_t count : {points.size(), std::size_t(129), std::size_t(128)}) {
          distances_in_bricks(bricks, frame, std::span(points).first(count),
                              std::span(found).first(count), simd);
          for (std::size_t i = 0; i < count; ++i)
            ASSERT_EQ(std::bit_cast<std::uint32_t>(found[i]),
                      std::bit_cast<std::uint32_t>(expected[i]))
                << points[i].transpose() << ", band " << band_mm;
        }
      }
    }
}

TEST(QueryMany, GivesTheBitsOfSingleQueries) {
  for (const TriangleMesh& mesh : {test::make_torus(20, 8, 60, 30), test::make_sheet(20, 4)})
    for (const DistanceField& field : fields_of(mesh))
      for (const int count : {0, 1, 31, 32, 33, 127, 128, 129, 512, 513, 20'000}) {
        const std::vector<Vec3> points = all_kinds_of_points(field, count, unsigned(count));
        std::vector<FieldSample> together(points.size());
        field.sample(points, together);
        std::vector<float> distances(points.size(), -1.0F);
        field.distances(points, distances);
        for (std::size_t i = 0; i < points.size(); ++i) {
          const FieldSample alone = field.sample(points[i]);
          ASSERT_TRUE(same_bits(alone, together[i])) << points[i].transpose();
          float distance = 0;
          field.distances(std::span(&points[i], 1), std::span(&distance, 1));
          ASSERT_EQ(std::bit_cast<std::uint32_t>(distance),
                    std::bit_cast<std::uint32_t>(distances[i]))
              << points[i].transpose();
          switch (alone.zone) {
            case Zone::kBand:
              // distances() is in single precision, sample() is not.
              ASSERT_NEAR(double(distance), alone.distance_mm, 1e-6 * field.band_mm())
                  << points[i].transpose();
              break;
            case Zone::kOutside:
              ASSERT_EQ(distance, std::numeric_limits<float>::infinity());
              break;
            case Zone::kInside:
              ASSERT_EQ(distance, -std::numeric_limits<float>::infinity());
              break;
            case Zone::kUnknown:
              ASSERT_TRUE(std::isnan(distance));
          }
        }
      }
}

TEST(QueryMany, SmoothGivesTheBitsOfSingleQueries) {
  for (const TriangleMesh& mesh : {test::make_torus(20, 8, 60, 30), test::make_sheet(20, 4)}) {
    const DistanceField field =
        build_distance_field(mesh, {.resolution = 32, .smooth = true}).value();
    for (const int count : {0, 1, 15, 16, 17, 64, 65, 5'000}) {
      const std::vector<Vec3> points = all_kinds_of_points(field, count, unsigned(count));
      std::vector<SmoothSample> together(points.size());
      field.sample_smooth(points, together);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const SmoothSample alone = field.sample_smooth(points[i]);
        ASSERT_TRUE(same_bits({alone.zone, alone.distance_mm, alone.gradient_B},
                              {together[i].zone, together[i].distance_mm, together[i].gradient_B}));
        ASSERT_EQ(alone.hessian_B, together[i].hessian_B);
      }
    }
  }
}

TEST(QueryMany, OutsideTheBandTheDistanceIsTheBandAndTheGradientZero) {
  for (const DistanceField& field : fields_of(test::make_torus(20, 8, 60, 30)))
    for (const Vec3& p : all_kinds_of_points(field, 20'000, 9)) {
      const FieldSample sample = field.sample(p);
      if (sample.zone == Zone::kBand) {
        ASSERT_TRUE(std::isfinite(sample.distance_mm) && sample.gradient_B.allFinite());
        continue;
      }
      ASSERT_EQ(sample.distance_mm,
                sample.zone == Zone::kInside ? -field.band_mm() : field.band_mm());
      ASSERT_TRUE(sample.gradient_B.isZero(0.0));
      // The surface is closed, so only points that are not finite are unknown.
      ASSERT_EQ(sample.zone == Zone::kUnknown, !p.allFinite()) << p.transpose();
    }
}

TEST(QueryMany, AtASampleGivesTheSample) {
  for (const DistanceField& field : fields_of(test::make_torus(20, 8, 60, 30))) {
    const int n = field.frame().resolution;
    for (int c = 0; c < n * n * n; ++c) {
      const LatticePoint low = {c % n, c / n % n, c / (n * n)};
      const CellSamples cell = field.cell(low);
      if (zone_of(cell.corners) != Zone::kBand || cell.low != low) continue;
      // Rounding may place the lattice plane slightly below the cell.
      const Vec3 p = test::position_of(field.frame(), low[0], low[1], low[2]);
      const FieldSample sample = field.sample(p);
      if (sample.zone != Zone::kBand) continue;
      ASSERT_NEAR(sample.distance_mm, double(cell.corners[0]), field.frame().tolerance_mm + 1e-6);
    }
  }
}

TEST(QueryMany, GivesTheSameFromManyThreads) {
  const DistanceField field =
      build_distance_field(test::make_torus(20, 8, 60, 30), {.resolution = 64}).value();
  const std::vector<Vec3> points = all_kinds_of_points(field, 20'000, 4);
  std::vector<FieldSample> together(points.size());
  field.sample(points, together);
  std::vector<std::uint8_t> same(points.size());
  const ThreadLimit limit(4);
  parallel_for(Index(points.size()), [&](Index i) {
    same[std::size_t(i)] =
        same_bits(field.sample(points[std::size_t(i)]), together[std::size_t(i)]);
  });
  EXPECT_EQ(std::count(same.begin(), same.end(), 1), std::ssize(same));
}

TEST(QueryMany, RequiresAsManyResultsAsPoints) {
  const DistanceField field =
      build_distance_field(test::make_icosphere(5, 1), {.resolution = 16}).value();
  const std::vector<Vec3> points(3, Vec3::Zero());
  std::vector<FieldSample> samples(2);
  std::vector<float> distances(4);
  EXPECT_THROW(field.sample(points, samples), LogicError);
  EXPECT_THROW(field.distances(points, distances), LogicError);
}

}  // namespace
}  // namespace lefort::field::test_query_bricks
