#include <lefort/core/parallel.h>
#include <lefort/field/far_sides.h>
#include <lefort/field/narrow_band.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lefort::field {

namespace {

constexpr int kSide = SparseLattice::kSide;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Carries the side of each of the kSide^2 rows through a brick.
void sweep_brick(std::span<float, SparseLattice::kBrickPoints> values,
                 std::array<bool, kSide * kSide>& inside) {
  for (std::size_t row = 0; row < inside.size(); ++row) {
    for (std::size_t i = 0; i < kSide; ++i) {
      float& value = values[row * kSide + i];
      if (std::isnan(value)) {
        value = inside[row] ? -kInfinity : kInfinity;
      } else {
        inside[row] = value < 0.0F;
      }
    }
  }
}

}  // namespace

float SidedDistances::at(const LatticePoint& point) const {
  float far = kFar;
  const Zone side = brick_sides[std::size_t(near.brick_of(point))];
  if (side != Zone::kUnknown) far = side == Zone::kInside ? -kInfinity : kInfinity;
  return near.at(point, far);
}

SidedDistances fill_far_sides(SparseLattice distances, bool closed) {
  const Index n = distances.bricks_per_side();
  SidedDistances filled{std::move(distances),
                        std::vector<Zone>(std::size_t(n * n * n), Zone::kUnknown)};
  if (!closed) return filled;
  const auto sweep_row_of_bricks = [&](Index row) {
    std::array<bool, kSide * kSide> inside{};
    for (Index b = row * n; b < (row + 1) * n; ++b) {
      const std::int32_t slot = filled.near.slot_of(std::int32_t(b));
      if (slot != SparseLattice::kNoBrick) {
        sweep_brick(filled.near.brick(slot), inside);
        continue;
      }
      // No surface near any point of this brick, so all its rows are on one side.
      filled.brick_sides[std::size_t(b)] = inside[0] ? Zone::kInside : Zone::kOutside;
      inside.fill(inside[0]);
    }
  };
  parallel_for(n * n, sweep_row_of_bricks, 16);
  return filled;
}

}  // namespace lefort::field
