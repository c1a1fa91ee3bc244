/// \file
/// Which points of a brick are known and which are inside, 64 to a word: what the space beyond the
/// band and contradictions between neighbors are found by.
#pragma once

#include <lefort/field/storage/sparse_lattice.h>

#include <array>
#include <cstdint>
#include <span>

namespace lefort::field {

/// A bit per point of a brick, x fastest, one word per z.
using BrickBits = std::array<std::uint64_t, std::size_t(SparseLattice::kSide)>;

struct BrickSigns {
  BrickBits known{};
  BrickBits inside{};  ///< Of those that are known.
  /// Of those that are known: more than half a cell from the surface. No surface passes between two
  /// neighbors that are, and their distances contradict each other if their signs do.
  BrickBits clear_of_surface{};

  [[nodiscard]] bool any_known() const {
    std::uint64_t any = 0;
    for (const std::uint64_t word : known) any |= word;
    return any != 0;
  }
};

/// The points of an octant (x fastest) of a brick within any of its four words.
[[nodiscard]] inline std::uint64_t octant_columns(int octant) {
  const std::uint64_t rows = (octant >> 1 & 1) != 0 ? 0xFFFFFFFF00000000 : 0x00000000FFFFFFFF;
  return rows & ((octant & 1) != 0 ? 0xF0F0F0F0F0F0F0F0 : 0x0F0F0F0F0F0F0F0F);
}

/// The lattice point at a place in the brick that begins at `first`.
[[nodiscard]] inline LatticePoint point_at(const LatticePoint& first, int place) {
  constexpr int kSide = SparseLattice::kSide;
  return {first[0] + place % kSide, first[1] + place / kSide % kSide,
          first[2] + place / (kSide * kSide)};
}

/// \param distances  NaN where not known.
[[nodiscard]] BrickSigns signs_of(std::span<const float, SparseLattice::kBrickPoints> distances);

/// Hands sides from point to point where no surface can pass: a point's distance is that of all its
/// surroundings.
///
/// \param to_find  known points whose side is not; those reached leave it. A point whose neighbors
///   disagree is not reached.
/// \param signs    has the sides of the other known points; receives those found.
void propagate_signs(BrickSigns& signs, BrickBits& to_find);

/// Pairs of known neighbors within the brick whose distances may contradict each other: on
/// different sides, and not both near the surface. By axis: bit i of axis k is the pair of point i
/// and the next along k.
[[nodiscard]] std::array<BrickBits, 3> possible_conflicts(const BrickSigns& signs);

/// Whether a known point has a neighbor in the brick that is not, on the other side: no surface
/// passes between them.
///
/// \param inside  of all points.
[[nodiscard]] bool unsampled_contradict(const BrickBits& known, const BrickBits& inside);

/// The points of a face of the brick, 64 to a word: the lowest or the highest along an axis, in an
/// order that is the same for both.
[[nodiscard]] std::uint64_t face_bits(const BrickBits& bits, int axis, bool highest);

/// Place in the brick of a bit of face_bits().
[[nodiscard]] int face_place(int bit, int axis, bool highest);

}  // namespace lefort::field
