#include <lefort/field/sign/settle_sides.h>
#include <lefort/field/sign/tear.h>

#include <array>
#include <bit>
#include <cmath>

namespace lefort::field {

namespace {

constexpr int kSide = SparseLattice::kSide;

/// Distances without sign never contradict each other, so only a change of sign can.
std::vector<std::size_t> torn_points(std::span<const float, SparseLattice::kBrickPoints> distances,
                                     const BrickSigns& signs, float cell_mm) {
  constexpr std::array<std::size_t, 3> kStride = {1, kSide, kSide * kSide};
  std::vector<std::size_t> torn;
  const std::array<BrickBits, 3> pairs = possible_tears(signs);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t z = 0; z < std::size_t(kSide); ++z)
      for (std::uint64_t word = pairs[axis][z]; word != 0; word &= word - 1) {
        const std::size_t i = z * 64 + std::size_t(std::countr_zero(word));
        if (is_torn(distances[i], distances[i + kStride[axis]], cell_mm))
          torn.insert(torn.end(), {i, i + kStride[axis]});
      }
  return torn;
}

}  // namespace

std::vector<std::size_t> settle_sides(std::span<float, SparseLattice::kBrickPoints> distances,
                                      BrickSigns& signs, const BrickBits& inside,
                                      const WindingRows* winding, std::int32_t brick,
                                      const FieldFrame& frame) {
  const auto cell_mm = float(frame.cell_mm);
  std::vector<std::size_t> torn = torn_points(distances, signs, cell_mm);
  if (winding == nullptr || (torn.empty() && !far_contradict(signs.known, inside))) return torn;
  const LatticePoint first = SparseLattice::first_point_of(brick, frame.resolution);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (!(std::abs(distances[i]) > cell_mm)) continue;  // Nor if not known.
    const bool is_inside = winding->is_inside(point_at(first, int(i)));
    distances[i] = std::copysign(distances[i], is_inside ? -1.0F : 1.0F);
    const std::uint64_t bit = std::uint64_t(1) << (i % 64);
    signs.inside[i / 64] = (signs.inside[i / 64] & ~bit) | (is_inside ? bit : 0);
  }
  return torn_points(distances, signs, cell_mm);
}

}  // namespace lefort::field
