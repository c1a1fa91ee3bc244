#include <lefort/core/check.h>
#include <lefort/field/build/build_bricks.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/storage/brick_samples.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "field/brute_force.h"
#include "support/shapes.h"

namespace lefort::field::test_brick_samples {
namespace {

using geometry::TriangleMesh;

const BrickSamples& bricks_of(const DistanceField& field) {
  return std::get<BrickSamples>(field.samples());
}

TEST(BrickSamples, CodesAreReadAsTheyWereWritten) {
  std::array<std::byte, 5> bytes{};
  for (const std::int32_t code :
       {0, 1, -1, 255, 256, -256, 65536, -65537, BrickSamples::kLargest, -BrickSamples::kLargest,
        BrickSamples::kBeyond, -BrickSamples::kBeyond, BrickSamples::kUnknown}) {
    bytes.fill(std::byte(0xA5));
    BrickSamples::write_code(bytes.data() + 1, code);
    EXPECT_EQ(BrickSamples::read_code(bytes.data() + 1), code);
    EXPECT_EQ(bytes[0], std::byte(0xA5));
    EXPECT_EQ(bytes[4], std::byte(0xA5));
  }
}

TEST(BrickSamples, OnlyCodesWithinTheBandAreDistances) {
  EXPECT_TRUE(BrickSamples::is_distance(BrickSamples::kLargest));
  EXPECT_TRUE(BrickSamples::is_distance(-BrickSamples::kLargest));
  for (const std::int32_t code :
       {BrickSamples::kBeyond, -BrickSamples::kBeyond, BrickSamples::kUnknown})
    EXPECT_FALSE(BrickSamples::is_distance(code));
}

TEST(BrickSamples, EveryPointHasItsOwnOffset) {
  // All leaves of all bricks are stored: 5^3 bricks of 8 leaves of 64 points.
  std::vector<Brick> table(125);
  for (std::uint32_t b = 0; b < 125; ++b) table[b] = {8 * b, 0xFF, 0, 0, 0};
  std::vector<std::byte> codes(125 * 8 * BrickSamples::kLeafBytes + 1);
  std::vector<int> visits(125 * 512, 0);
  const BrickSamples samples(16, 4.0, std::move(table), std::move(codes));
  EXPECT_EQ(samples.leaf_count(), 1000);
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) {
        const std::ptrdiff_t at = samples.code_address({i, j, k}) - samples.codes().data();
        ASSERT_EQ(at % 3, 0);
        ASSERT_EQ(visits[std::size_t(at / 3)]++, 0) << i << ' ' << j << ' ' << k;
      }
}

TEST(BrickSamples, LeavesThatAreNotStoredHaveAZone) {
  std::vector<Brick> table(125);
  table[31] = {0, 0, 0b10, 0b100, 0};  // Begins at point (0, 0, 0).
  const BrickSamples samples(16, 4.0, std::move(table), std::vector<std::byte>(1));
  const auto zone_at = [&](const LatticePoint& low) { return zone_of(samples.cell(low).corners); };
  EXPECT_EQ(zone_at({0, 0, 0}), Zone::kOutside);
  EXPECT_EQ(zone_at({4, 0, 0}), Zone::kInside);
  EXPECT_EQ(zone_at({0, 4, 0}), Zone::kUnknown);
  EXPECT_EQ(zone_at({3, 0, 0}), Zone::kUnknown);  // Half outside, half inside.
  EXPECT_EQ(zone_at({15, 15, 15}), Zone::kOutside);
}

TEST(BrickSamples, TableAndLeavesMustHaveTheRightSize) {
  EXPECT_THROW(BrickSamples(16, 4.0, std::vector<Brick>(124), std::vector<std::byte>(1)),
               LogicError);
  EXPECT_THROW(BrickSamples(16, 4.0, std::vector<Brick>(125), std::vector<std::byte>(192)),
               LogicError);
}

TEST(BuildBricks, MemoryIsProportionalToTheAreaOfTheSurface) {
  // Number of leaves of 4 x 4 x 4 points that overlap a band of +-b around an area A, all in cells:
  // those whose points, a cube of 3, are closer than b. A cube of side 3 has the mean width 4.5, so
  // it is A (2 b + 4.5) / 64; curvature adds at most (4 pi / 3) (b + 2.25)^3 / 32, which is
  // negligible.
  for (const int resolution : {128, 512}) {
    const DistanceField field =
        build_distance_field(test::make_icosphere(50, 6), {.resolution = resolution}).value();
    const double radius = 50 / field.cell_mm(), band = field.band_mm() / field.cell_mm();
    const double area = 4 * std::numbers::pi * radius * radius;
    const double leaves = area * (2 * band + 4.5) / 64;
    EXPECT_NEAR(double(bricks_of(field).leaf_count()), leaves, 0.02 * leaves);
    const double side = resolution / 8 + 3;
    EXPECT_EQ(field.sample_bytes(),
              std::size_t(bricks_of(field).leaf_count()) * BrickSamples::kLeafBytes + 1 +
                  std::size_t(side * side * side) * sizeof(Brick));
    EXPECT_LT(double(field.sample_bytes()), 1.02 * leaves * 192 + side * side * side * 8 + 1);
  }
}

TEST(BuildBricks, EveryStoredLeafContainsADistance) {
  const DistanceField field =
      build_distance_field(test::make_torus(20, 8, 60, 30), {.resolution = 64}).value();
  const BrickSamples& samples = bricks_of(field);
  for (Index leaf = 0; leaf < samples.leaf_count(); ++leaf) {
    bool known = false;
    for (int i = 0; i < BrickSamples::kLeafPoints; ++i)
      known = known || BrickSamples::is_distance(BrickSamples::read_code(
                           samples.codes().data() + std::size_t(leaf) * BrickSamples::kLeafBytes +
                           std::size_t(i) * BrickSamples::kCodeBytes));
    ASSERT_TRUE(known) << leaf;
  }
}

TEST(BuildBricks, AClosedSurfaceHasNoUnknownSamplesForAnyRoundingOfTheBand) {
  // Lattice planes are one band from the faces of the box, up to rounding: such samples may be in
  // the band or not, but their codes must not overflow.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in(0.1, 90);
  for (int n = 0; n < 100; ++n) {
    const double side = in(random), cells = 3 + int(random() % 4);
    const double cell = side / (32 - 2 * cells);
    const Vec3 low(in(random), in(random), in(random));
    const DistanceField field =
        build_distance_field(test::make_box(low, low + Vec3::Constant(side)),
                             {.resolution = 32, .band_mm = cells * cell})
            .value();
    int unknown = 0, wrong = 0;
    for (int c = 0; c < 32 * 32 * 32; ++c) {
      const LatticePoint at = {c % 32, c / 32 % 32, c / 1024};
      unknown += zone_of(field.cell(at).corners) == Zone::kUnknown;
      for (int corner = 0; corner < 8; ++corner) {
        const float d = field.cell(at).corners[std::size_t(corner)];
        const Vec3 p = test::position_of(field.frame(), at[0] + (corner & 1),
                                         at[1] + (corner >> 1 & 1), at[2] + (corner >> 2));
        const bool inside = ((p - low).array() > 0).all() && ((p - low).array() < side).all();
        wrong += std::abs(d) > 1e-3 * side && inside != (d < 0);
      }
    }
    EXPECT_EQ(unknown, 0) << "side " << side << " band " << cells;
    EXPECT_EQ(wrong, 0) << "side " << side << " band " << cells;
  }
}

TEST(BuildBricks, NoDistanceOverflowsItsCode) {
  // The same with random bands, so that the largest codes are rounded in all ways.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> in(0.5, 50);
  int near_the_edge = 0;
  for (int n = 0; n < 2000; ++n) {
    FieldFrame frame;
    frame.resolution = 16;
    frame.band_mm = in(random);
    frame.cell_mm = frame.band_mm / 3;
    frame.origin_B = Vec3::Constant(-8 * frame.cell_mm);
    frame.closed = true;
    // A face at a height such that lattice points are just inside the band.
    const double z = frame.band_mm * 5e-8 * double(random() % 8);
    const double half = 4 * frame.cell_mm;
    const PreparedSurface surface =
        prepare_surface(test::make_box(Vec3(-half, -half, -half), Vec3(half, half, z))).value();
    const BandSampler sampler = BandSampler::create(surface, frame, frame.band_mm).value();
    const WindingScanlines winding(surface.mesh_B, frame);
    const auto samples = build_bricks(sampler, frame, &winding, nullptr, Progress::none());
    ASSERT_TRUE(samples);
    const std::int32_t code = BrickSamples::read_code(samples->code_address({8, 8, 11}));
    EXPECT_GE(code, BrickSamples::kLargest - 8) << frame.band_mm;  // Neither unknown nor inside.
    near_the_edge += BrickSamples::is_distance(code) ? 1 : 0;
  }
  EXPECT_GT(near_the_edge, 500);
}

/// Bricks and the wide lattice are made from the same samples.
TEST(BuildBricks, AWideLatticeHasTheSamplesOfTheNarrowBand) {
  const TriangleMesh ball = test::make_icosphere(10.0, 3);
  const PreparedSurface surface = prepare_surface(ball).value();
  FieldFrame frame{.origin_B = Vec3::Constant(-16.0), .cell_mm = 1.0, .resolution = 32};
  frame.band_mm = 2.5;
  frame.closed = true;
  constexpr double kWide_mm = 4.5;
  const WindingScanlines winding(surface.mesh_B, frame);
  const BandSampler sampler = BandSampler::create(surface, frame, kWide_mm).value();
  const std::span<const std::int32_t> bricks = sampler.bricks();
  SparseLattice wide(frame.resolution, {bricks.begin(), bricks.end()}, kUnsampled);
  const BrickSamples both = build_bricks(sampler, frame, &winding, &wide, Progress::none()).value();
  const SparseLattice alone =
      sample_narrow_band(surface, frame, kWide_mm, &winding, Progress::none()).value();
  const BrickSamples narrow =
      build_bricks(BandSampler::create(surface, frame, frame.band_mm).value(), frame, &winding,
                   nullptr, Progress::none())
          .value();
  Index known = 0;
  for (Index slot = 0; slot < wide.brick_count(); ++slot)
    for (std::size_t i = 0; i < std::size_t(SparseLattice::kBrickPoints); ++i) {
      const float a = wide.brick(slot)[i], b = alone.brick(slot)[i];
      ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
      known += std::isnan(a) ? 0 : 1;
    }
  EXPECT_GT(known, 5000);
  for (int k = 0; k <= frame.resolution; ++k)
    for (int j = 0; j <= frame.resolution; ++j)
      for (int i = 0; i <= frame.resolution; ++i)
        ASSERT_EQ(BrickSamples::read_code(both.code_address({i, j, k})),
                  BrickSamples::read_code(narrow.code_address({i, j, k})));
}

TEST(BuildBricks, ALeafWhoseOnlySampleIsInConflictIsUnknownThere) {
  // A small triangle mesh inside a box, placed so that one lattice point of a leaf is in its band
  // and all other points of the leaf are in no band. That point is in conflict with a neighbor in
  // its brick and one in the next brick; the box is closest to both.
  FieldFrame frame;
  frame.resolution = 32;
  frame.cell_mm = 1.0;
  frame.band_mm = 2.0;
  const TriangleMesh speck = test::make_icosphere(1e-3, 0, Vec3(15.5, 11.5, 12.82));
  PreparedSurface surface =
      prepare_surface(test::join(test::make_box(Vec3(2.5, 2.5, 2.5), Vec3(17.9, 13.9, 28)), speck))
          .value();
  surface.closed = false;  // As for an open surface, no other point determines the sign.
  const auto samples = build_bricks(BandSampler::create(surface, frame, 2.0).value(), frame,
                                    nullptr, nullptr, Progress::none());
  ASSERT_TRUE(samples);
  for (const LatticePoint& p :
       {LatticePoint{15, 11, 11}, LatticePoint{15, 12, 11}, LatticePoint{16, 11, 11}}) {
    EXPECT_EQ(BrickSamples::read_code(samples->code_address(p)), BrickSamples::kUnknown)
        << p[0] << ' ' << p[1] << ' ' << p[2];
  }
}

TEST(BuildBricks, TheWindingNumberResolvesSignConflicts) {
  // As above. The outside of the small mesh faces points inside the box.
  FieldFrame frame;
  frame.resolution = 32;
  frame.cell_mm = 1.0;
  frame.band_mm = 2.0;
  frame.closed = true;
  const TriangleMesh speck = test::make_icosphere(1e-3, 0, Vec3(15.5, 11.5, 12.82));
  const PreparedSurface surface =
      prepare_surface(test::join(test::make_box(Vec3(2.5, 2.5, 2.5), Vec3(17.9, 13.9, 28)), speck))
          .value();
  ASSERT_TRUE(surface.closed);
  const WindingScanlines winding(surface.mesh_B, frame);
  const auto samples = build_bricks(BandSampler::create(surface, frame, 2.0).value(), frame,
                                    &winding, nullptr, Progress::none());
  ASSERT_TRUE(samples);
  const std::int32_t code = BrickSamples::read_code(samples->code_address({16, 11, 11}));
  ASSERT_TRUE(BrickSamples::is_distance(code));
  EXPECT_LT(code, 0);
}

TEST(BuildBricks, BothSamplesOfASignConflictAreUnknown) {
  const TriangleMesh sheet = test::make_sheet(20, 4);
  const DistanceField field = build_distance_field(sheet, {.resolution = 64}).value();
  const int n = field.frame().resolution;
  int in_conflict = 0;
  for (int c = 0; c < n * n * n; ++c) {
    const CellSamples cell = field.cell({c % n, c / n % n, c / (n * n)});
    if (zone_of(cell.corners) == Zone::kUnknown) ++in_conflict;
    if (zone_of(cell.corners) != Zone::kBand) continue;
    for (std::size_t corner = 0; corner < 8; ++corner)
      for (std::size_t axis = 1; axis < 8; axis *= 2)
        ASSERT_LE(std::abs(cell.corners[corner] - cell.corners[corner ^ axis]),
                  1.002 * field.cell_mm());
  }
  EXPECT_GT(in_conflict, 100);
}

}  // namespace
}  // namespace lefort::field::test_brick_samples
