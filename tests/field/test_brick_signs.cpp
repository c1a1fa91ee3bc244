#include <lefort/field/brick_signs.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace lefort::field {
namespace {

constexpr int kSide = SparseLattice::kSide;
using Distances = std::array<float, SparseLattice::kBrickPoints>;

int place_at(int x, int y, int z) { return (z * kSide + y) * kSide + x; }
bool bit_of(const BrickBits& bits, int place) {
  return (bits[std::size_t(place / 64)] >> (place % 64) & 1) != 0;
}

/// Distances of both signs and both zeros, and more or fewer that are not known.
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

TEST(BrickSigns, SayWhatIsKnownAndWhatIsInside) {
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

TEST(BrickSigns, FacesOfNeighboursMatchBitByBit) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const BrickSigns signs = signs_of(any_distances(random));
    for (int axis = 0; axis < 3; ++axis)
      for (int bit = 0; bit < 64; ++bit) {
        const int low = face_place(bit, axis, false), high = face_place(bit, axis, true);
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
  EXPECT_EQ(face_place(0, 0, true), place_at(7, 0, 0));
}

}  // namespace
}  // namespace lefort::field
