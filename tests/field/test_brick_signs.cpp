#include <lefort/field/sign/brick_signs.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace lefort::field::test_brick_signs {
namespace {

constexpr int kSide = SparseLattice::kSide;
using Distances = std::array<float, SparseLattice::kBrickPoints>;

int place_at(int x, int y, int z) { return (z * kSide + y) * kSide + x; }
bool bit_of(const BrickBits& bits, int place) {
  return (bits[std::size_t(place / 64)] >> (place % 64) & 1) != 0;
}

/// Distances of both signs and both zeros, with different fractions of unknown ones.
Distances any_distances(std::mt19937& random) {
  const auto known_in_16 = 1 + random() % 16;
  Distances d;
  for (float& value : d) {
    value = float(random() % 5) - 2.0F;
    if (random() % 8 == 0) value = -0.0F;
    if (random() % 16 >= known_in_16) value = std::numeric_limits<float>::quiet_NaN();
  }
  d[random() % d.size()] = 1.0F;
  return d;
}

TEST(BrickSigns, RecordKnownAndInsidePoints) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const Distances d = any_distances(random);
    const BrickSigns signs = signs_of(d);
    EXPECT_TRUE(signs.any_known());
    for (int i = 0; i < SparseLattice::kBrickPoints; ++i) {
      ASSERT_EQ(bit_of(signs.known, i), !std::isnan(d[std::size_t(i)])) << seed;
      ASSERT_EQ(bit_of(signs.inside, i), d[std::size_t(i)] < 0.0F) << seed;  // Zero is outside.
    }
  }
  Distances none;
  none.fill(std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(signs_of(none).any_known());
}

TEST(BrickSigns, FacesOfNeighborsMatchBitByBit) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const BrickSigns signs = signs_of(any_distances(random));
    for (int axis = 0; axis < 3; ++axis)
      for (int bit = 0; bit < 64; ++bit) {
        const int low = face_offset(bit, axis, false), high = face_offset(bit, axis, true);
        constexpr std::array<int, 3> kStride = {1, kSide, kSide * kSide};
        ASSERT_EQ(high - low, (kSide - 1) * kStride[std::size_t(axis)]);
        ASSERT_EQ(low / kStride[std::size_t(axis)] % kSide, 0);
        for (const bool highest : {false, true}) {
          const int place = highest ? high : low;
          ASSERT_EQ((face_bits(signs.inside, axis, highest) >> bit & 1) != 0,
                    bit_of(signs.inside, place))
              << seed << ", axis " << axis << ", bit " << bit;
        }
      }
  }
  EXPECT_EQ(face_offset(0, 0, true), place_at(7, 0, 0));
}

/// Random signs; one point in four is unknown, and one in three close to the surface.
BrickSigns any_signs(std::mt19937& random) {
  BrickSigns signs;
  for (std::size_t z = 0; z < std::size_t(kSide); ++z)
    for (int i = 0; i < 64; ++i) {
      const std::uint64_t bit = std::uint64_t(1) << i;
      if (random() % 4 == 0) continue;
      signs.known[z] |= bit;
      if (random() % 2 == 0) signs.inside[z] |= bit;
      if (random() % 3 != 0) signs.clear_of_surface[z] |= bit;
    }
  return signs;
}

/// The next point along an axis, or -1 at the end of the brick.
int next_place(int place, int axis, int step = 1) {
  constexpr std::array<int, 3> kStride = {1, kSide, kSide * kSide};
  const int at = place / kStride[std::size_t(axis)] % kSide + step;
  return at < 0 || at >= kSide ? -1 : place + step * kStride[std::size_t(axis)];
}

TEST(BrickSigns, NeighborsOfDifferentSignMayBeInConflictUnlessBothAreClose) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    const BrickSigns signs = any_signs(random);
    const std::array<BrickBits, 3> conflicts = possible_conflicts(signs);
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < SparseLattice::kBrickPoints; ++i) {
        const int j = next_place(i, axis);
        const bool expected =
            j >= 0 && bit_of(signs.known, i) && bit_of(signs.known, j) &&
            bit_of(signs.inside, i) != bit_of(signs.inside, j) &&
            (bit_of(signs.clear_of_surface, i) || bit_of(signs.clear_of_surface, j));
        ASSERT_EQ(bit_of(conflicts[std::size_t(axis)], i), expected)
            << "axis " << axis << ", " << i;
      }
  }
}

TEST(BrickSigns, UnsampledPointsAreInConflictWithKnownNeighborsOfTheOtherSign) {
  // One pair along each axis, and the last point of a row with the first of the next, which are not
  // neighbors.
  const auto contradict = [](std::size_t known_place, std::size_t far_place, bool far_is_inside) {
    BrickBits known{}, inside{};
    known[known_place / 64] |= std::uint64_t(1) << (known_place % 64);
    if (far_is_inside) inside[far_place / 64] |= std::uint64_t(1) << (far_place % 64);
    return unsampled_contradict(known, inside);
  };
  for (const std::size_t stride : {1, 8, 64}) {
    EXPECT_TRUE(contradict(9 + 64, 9 + 64 + stride, true)) << stride;
    EXPECT_TRUE(contradict(9 + 64 + stride, 9 + 64, true)) << stride;
    EXPECT_FALSE(contradict(9 + 64, 9 + 64 + stride, false)) << stride;
  }
  EXPECT_FALSE(contradict(7, 8, true));
  EXPECT_FALSE(contradict(63, 64, true));
  EXPECT_TRUE(contradict(63, 127, true));
  EXPECT_TRUE(contradict(511, 510, true));
}

TEST(BrickSigns, SignsPropagateWhereTheSurfaceCannotPass) {
  std::mt19937 random(11);
  for (int round = 0; round < 50; ++round) {
    BrickSigns signs = any_signs(random);
    BrickBits to_find{};
    for (std::size_t z = 0; z < std::size_t(kSide); ++z) {
      to_find[z] = signs.known[z] & (std::uint64_t(random()) << 32 | random());
      signs.inside[z] &= ~to_find[z];
    }
    const BrickBits requested = to_find;
    const BrickSigns before = signs;
    propagate_signs(signs, to_find);
    for (int i = 0; i < SparseLattice::kBrickPoints; ++i) {
      if (!bit_of(requested, i)) {
        ASSERT_EQ(bit_of(signs.inside, i), bit_of(before.inside, i)) << "was known before: " << i;
        ASSERT_FALSE(bit_of(to_find, i));
        continue;
      }
      // One step earlier its neighbors agreed; the points left at the end have none, or conflicting
      // ones.
      int in = 0, out = 0;
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          const int j = next_place(i, axis, step);
          if (j < 0 || !bit_of(signs.clear_of_surface, j) || bit_of(to_find, j)) continue;
          ++(bit_of(signs.inside, j) ? in : out);
        }
      const bool found = !bit_of(to_find, i);
      if (!bit_of(signs.clear_of_surface, i)) {
        ASSERT_FALSE(found) << "close to the surface: " << i;
      } else if (found) {
        ASSERT_GT(bit_of(signs.inside, i) ? in : out, 0) << i;
      } else {
        ASSERT_EQ(in == 0, out == 0) << i;
      }
    }
  }
}

TEST(BrickSigns, ASignPropagatesToTheOtherEndOfTheBrick) {
  BrickSigns signs;
  signs.known.fill(~std::uint64_t(0));
  signs.clear_of_surface = signs.known;
  signs.inside[0] = 1;
  BrickBits to_find = signs.known;
  to_find[0] &= ~std::uint64_t(1);
  propagate_signs(signs, to_find);
  EXPECT_EQ(to_find, BrickBits{});
  EXPECT_EQ(signs.inside, signs.known);
}

}  // namespace
}  // namespace lefort::field::test_brick_signs
