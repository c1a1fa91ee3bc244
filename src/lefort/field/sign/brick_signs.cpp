#include <lefort/field/sign/brick_signs.h>

#include <cmath>

namespace lefort::field {

namespace {

constexpr auto kSideWords = std::size_t(SparseLattice::kSide);
static_assert(kSideWords == 8, "a slice of a brick is a word");
constexpr std::uint64_t kFirstColumn = 0x0101010101010101;

constexpr std::uint64_t columns_until(unsigned count) {
  return kFirstColumn * ((1U << count) - 1U);
}

}  // namespace

BrickSigns signs_of(std::span<const float, SparseLattice::kBrickPoints> distances) {
  BrickSigns signs;
  for (std::size_t z = 0; z < kSideWords; ++z)
    for (std::size_t i = 0; i < 64; ++i) {
      const float d = distances[z * 64 + i];
      signs.known[z] |= std::uint64_t(!std::isnan(d)) << i;
      signs.inside[z] |= std::uint64_t(d < 0.0F) << i;
    }
  return signs;
}

void propagate_signs(BrickSigns& signs, BrickBits& to_find) {
  const auto from_neighbors = [](const BrickBits& bits, std::size_t z) {
    const std::uint64_t here = bits[z];
    return (here << 1 & ~kFirstColumn) | (here >> 1 & columns_until(7)) | here << 8 | here >> 8 |
           (z > 0 ? bits[z - 1] : 0) | (z + 1 < kSideWords ? bits[z + 1] : 0);
  };
  for (bool moved = true; moved;) {
    moved = false;
    BrickBits inside{}, outside{};
    for (std::size_t z = 0; z < kSideWords; ++z) {
      const std::uint64_t propagate = signs.clear_of_surface[z] & ~to_find[z];
      inside[z] = propagate & signs.inside[z];
      outside[z] = propagate & ~signs.inside[z];
    }
    for (std::size_t z = 0; z < kSideWords; ++z) {
      const std::uint64_t to_decide = to_find[z] & signs.clear_of_surface[z];
      if (to_decide == 0) continue;
      const std::uint64_t in = from_neighbors(inside, z), out = from_neighbors(outside, z);
      const std::uint64_t found = to_decide & (in ^ out);
      signs.inside[z] |= found & in;
      to_find[z] &= ~found;
      moved |= found != 0;
    }
  }
}

std::array<BrickBits, 3> possible_conflicts(const BrickSigns& signs) {
  std::array<BrickBits, 3> pairs{};
  for (std::size_t z = 0; z < kSideWords; ++z) {
    const std::uint64_t known = signs.known[z], inside = signs.inside[z],
                        clear_of_surface = signs.clear_of_surface[z];
    pairs[0][z] = (inside ^ inside >> 1) & known & known >> 1 &
                  (clear_of_surface | clear_of_surface >> 1) & columns_until(7);
    pairs[1][z] =
        (inside ^ inside >> 8) & known & known >> 8 & (clear_of_surface | clear_of_surface >> 8);
    if (z + 1 < kSideWords)
      pairs[2][z] = (inside ^ signs.inside[z + 1]) & known & signs.known[z + 1] &
                    (clear_of_surface | signs.clear_of_surface[z + 1]);
  }
  return pairs;
}

bool unsampled_contradict(const BrickBits& known, const BrickBits& inside) {
  std::uint64_t found = 0;
  for (std::size_t z = 0; z < kSideWords; ++z) {
    const std::uint64_t k = known[z], in = inside[z];
    found |= (k ^ k >> 1) & (in ^ in >> 1) & columns_until(7);
    found |= (k ^ k >> 8) & (in ^ in >> 8) & ~std::uint64_t(0) >> 8;
    if (z + 1 < kSideWords) found |= (k ^ known[z + 1]) & (in ^ inside[z + 1]);
  }
  return found != 0;
}

std::uint64_t face_bits(const BrickBits& bits, int axis, bool highest) {
  if (axis == 2) return bits[highest ? kSideWords - 1 : 0];
  std::uint64_t face = 0;
  for (std::size_t z = 0; z < kSideWords; ++z) {
    std::uint64_t row = 0;
    if (axis == 1) {
      row = bits[z] >> (highest ? 56 : 0) & 0xFF;
    } else {
      // A product gathers the eight bits of the column in one byte.
      const std::uint64_t column = bits[z] >> (highest ? 7 : 0) & kFirstColumn;
      row = column * 0x0102040810204080 >> 56;
    }
    face |= row << (8 * z);
  }
  return face;
}

int face_offset(int bit, int axis, bool highest) {
  constexpr int kPoints = SparseLattice::kSide;
  const int end = highest ? kPoints - 1 : 0, low = bit % kPoints, high = bit / kPoints;
  if (axis == 2) return (end * kPoints + high) * kPoints + low;
  if (axis == 1) return (high * kPoints + end) * kPoints + low;
  return (high * kPoints + low) * kPoints + end;
}

}  // namespace lefort::field
