#include <lefort/field/sign/resolve_sign_conflicts.h>
#include <lefort/field/sign/violates_lipschitz.h>

#include <array>
#include <bit>
#include <cmath>

namespace lefort::field {

namespace {

/// Unsigned distances are never in conflict, so only pairs with different signs are tested.
std::vector<std::size_t> conflicting_points(
    std::span<const float, SparseLattice::kBrickPoints> distances, const BrickSigns& signs,
    float cell_mm) {
  constexpr std::array<std::size_t, 3> kStride = {1, kBrickSide, kBrickSide * kBrickSide};
  std::vector<std::size_t> in_conflict;
  const std::array<BrickBits, 3> pairs = possible_conflicts(signs);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t z = 0; z < std::size_t(kBrickSide); ++z)
      for (std::uint64_t word = pairs[axis][z]; word != 0; word &= word - 1) {
        const std::size_t i = z * 64 + std::size_t(std::countr_zero(word));
        if (violates_lipschitz(distances[i], distances[i + kStride[axis]], cell_mm))
          in_conflict.insert(in_conflict.end(), {i, i + kStride[axis]});
      }
  return in_conflict;
}

}  // namespace

std::vector<std::size_t> resolve_sign_conflicts(
    std::span<float, SparseLattice::kBrickPoints> distances, BrickSigns& signs,
    const BrickBits& inside, const WindingScanlines* winding, std::int32_t brick,
    const FieldFrame& frame) {
  const auto cell_mm = float(frame.cell_mm);
  std::vector<std::size_t> in_conflict = conflicting_points(distances, signs, cell_mm);
  if (winding == nullptr || (in_conflict.empty() && !unsampled_contradict(signs.known, inside)))
    return in_conflict;
  const LatticePoint first = SparseLattice::first_point_of(brick, frame.resolution);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (!(std::abs(distances[i]) > cell_mm)) continue;  // Also skips NaN.
    const bool is_inside = winding->is_inside(point_at(first, int(i)));
    distances[i] = std::copysign(distances[i], is_inside ? -1.0F : 1.0F);
    const std::uint64_t bit = std::uint64_t(1) << (i % 64);
    signs.inside[i / 64] = (signs.inside[i / 64] & ~bit) | (is_inside ? bit : 0);
  }
  return conflicting_points(distances, signs, cell_mm);
}

}  // namespace lefort::field
