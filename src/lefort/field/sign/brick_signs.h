/// \file
/// Known points and inside points of a brick as masks of 64 bits, for sign propagation and for the
/// detection of sign conflicts.
#pragma once

#include <lefort/field/storage/sparse_lattice.h>

#include <array>
#include <cstdint>
#include <span>

namespace lefort::field {

/// One bit per point of a brick, x fastest, one word per z.
using BrickBits = std::array<std::uint64_t, std::size_t(SparseLattice::kSide)>;

/// Signs of the points of a brick.
struct BrickSigns {
  BrickBits known{};
  BrickBits inside{};  ///< Of known points.
  /// Known points further than half a cell from the surface. The surface does not pass between two
  /// such neighbors, so they are in conflict if their signs differ.
  BrickBits clear_of_surface{};

  [[nodiscard]] bool any_known() const {
    std::uint64_t any = 0;
    for (const std::uint64_t word : known) any |= word;
    return any != 0;
  }
};

/// Mask of the points of an octant (0 to 7, x fastest) of a brick, the same in each of the octant's
/// four words.
[[nodiscard]] inline std::uint64_t octant_columns(int octant) {
  const std::uint64_t rows = (octant >> 1 & 1) != 0 ? 0xFFFFFFFF00000000 : 0x00000000FFFFFFFF;
  return rows & ((octant & 1) != 0 ? 0xF0F0F0F0F0F0F0F0 : 0x0F0F0F0F0F0F0F0F);
}

/// The lattice point at an offset in the brick whose first point is `first`.
[[nodiscard]] inline LatticePoint point_at(const LatticePoint& first, int offset) {
  constexpr int kSide = SparseLattice::kSide;
  return {first[0] + offset % kSide, first[1] + offset / kSide % kSide,
          first[2] + offset / (kSide * kSide)};
}

/// Signs of given distances; clear_of_surface remains empty.
///
/// \param distances  NaN where unknown.
[[nodiscard]] BrickSigns signs_of(std::span<const float, SparseLattice::kBrickPoints> distances);

/// Propagates signs between neighbors that the surface cannot separate (flood fill).
///
/// \param signs    has the signs of known points outside `to_find`; receives those found.
/// \param to_find  known points without a sign; those found are removed. A point is found if it is
///   clear of the surface, and the neighbors that have a sign and are clear of the surface exist
///   and agree.
void propagate_signs(BrickSigns& signs, BrickBits& to_find);

/// Pairs of known neighbors in the brick whose distances may be in conflict: with different signs,
/// and not both close to the surface. Bit i of axis k is the pair of point i and its successor
/// along k.
[[nodiscard]] std::array<BrickBits, 3> possible_conflicts(const BrickSigns& signs);

/// True if a known point and an unsampled neighbor in the brick have different signs, although the
/// surface cannot pass between them.
///
/// \param known   known points.
/// \param inside  of all points.
[[nodiscard]] bool unsampled_contradict(const BrickBits& known, const BrickBits& inside);

/// The points of a face of the brick, 64 to a word: the lowest or the highest along an axis, in the
/// same order for both.
[[nodiscard]] std::uint64_t face_bits(const BrickBits& bits, int axis, bool highest);

/// Offset in the brick of a bit of face_bits().
[[nodiscard]] int face_offset(int bit, int axis, bool highest);

}  // namespace lefort::field
