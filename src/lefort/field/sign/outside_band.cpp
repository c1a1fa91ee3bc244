#include <lefort/core/parallel.h>
#include <lefort/field/query/cell_samples.h>
#include <lefort/field/sign/outside_band.h>

#include <bit>
#include <optional>
#include <utility>

namespace lefort::field {

namespace {

/// Half the diagonal of 4 x 4 x 4 points, in cells.
constexpr double kHalfOctant = 2.6;

}  // namespace

BrickBits inside_with_unsampled(const BrickSigns& signs, const WindingScanlines& winding,
                                std::int32_t brick, const FieldFrame& frame) {
  const LatticePoint first = SparseLattice::first_point_of(brick, frame.resolution);
  const bool same_sign_in_octant = frame.band_mm >= kHalfOctant * frame.cell_mm;
  BrickBits inside = signs.inside;
  for (int octant = 0; octant < 8; ++octant) {
    std::optional<bool> side;
    const auto z_low = std::size_t(octant >> 2) * 4;
    for (std::size_t z = z_low; z < z_low + 4; ++z) {
      std::uint64_t far = ~signs.known[z] & octant_columns(octant);
      for (std::uint64_t left = far; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        if (!side || !same_sign_in_octant)
          side = winding.is_inside(point_at(first, int(z) * 64 + bit));
        if (!same_sign_in_octant && *side) inside[z] |= std::uint64_t(1) << bit;
        if (same_sign_in_octant) break;
      }
      if (same_sign_in_octant && side.value_or(false)) inside[z] |= far;
    }
  }
  return inside;
}

void fill_points_outside_band(std::span<float, SparseLattice::kBrickPoints> distances,
                              const WindingScanlines& winding, std::int32_t brick,
                              const FieldFrame& frame) {
  const BrickSigns signs = signs_of(distances);
  const BrickBits inside = inside_with_unsampled(signs, winding, brick, frame);
  for (std::size_t i = 0; i < distances.size(); ++i)
    if ((signs.known[i / 64] >> (i % 64) & 1) == 0)
      distances[i] =
          zone_value((inside[i / 64] >> (i % 64) & 1) != 0 ? Zone::kInside : Zone::kOutside);
}

Zone zone_of_empty_brick(const WindingScanlines& winding, std::int32_t brick, int resolution) {
  const LatticePoint first = SparseLattice::first_point_of(brick, resolution);
  return winding.is_inside(first) ? Zone::kInside : Zone::kOutside;
}

float SignedDistances::at(const LatticePoint& point) const {
  const std::int32_t brick = near.brick_of(point);
  const std::int32_t slot = near.slot_of(brick);
  if (slot != SparseLattice::kNoBrick)
    return near.brick(slot)[std::size_t(SparseLattice::linear_offset(point))];
  return zone_value(brick_zones[std::size_t(brick)]);
}

SignedDistances fill_outside_band(SparseLattice distances, const FieldFrame& frame,
                                  const WindingScanlines* winding) {
  const int resolution = distances.resolution();
  const auto n = std::size_t(distances.bricks_per_side());
  std::vector<Zone> zones(n * n * n, Zone::kUnknown);
  if (winding == nullptr) return {std::move(distances), std::move(zones)};
  parallel_for(Index(zones.size()), [&](Index b) {
    const auto brick = std::int32_t(b);
    const std::int32_t slot = distances.slot_of(brick);
    if (slot == SparseLattice::kNoBrick) {
      zones[std::size_t(b)] = zone_of_empty_brick(*winding, brick, resolution);
    } else {
      fill_points_outside_band(distances.brick(slot), *winding, brick, frame);
      zones[std::size_t(b)] = Zone::kBand;
    }
  });
  return {std::move(distances), std::move(zones)};
}

}  // namespace lefort::field
