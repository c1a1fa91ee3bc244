/// \file
/// Which side of a closed surface the space beyond the band is on.
#pragma once

#include <lefort/field/sign/brick_signs.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::field {

/// Sides of all points of a brick: those that are known, and the far ones by the winding number, so
/// that no wrong sign spreads from where a surface cuts through itself.
///
/// Far points within four of each other along each axis (5.2 cells) are on one side if the surface
/// is further than half of that from both; so eight questions do for a brick.
[[nodiscard]] BrickBits inside_with_unsampled(const BrickSigns& signs,
                                              const WindingScanlines& winding, std::int32_t brick,
                                              const FieldFrame& frame);

/// Gives far points (NaN) of a brick +infinity outside and -infinity inside.
void fill_points_outside_band(std::span<float, SparseLattice::kBrickPoints> distances,
                              const WindingScanlines& winding, std::int32_t brick,
                              const FieldFrame& frame);

/// Side of a brick that holds no known point.
[[nodiscard]] Zone side_of_empty_brick(const WindingScanlines& winding, std::int32_t brick,
                                       int resolution);

/// A signed distance for every point of the lattice: +-infinity far from the surface, by side, or
/// NaN where an open surface leaves the side unknown.
struct SignedDistances {
  SparseLattice near;
  std::vector<Zone> brick_sides;  ///< Of the bricks that `near` does not have, by brick number.

  [[nodiscard]] float at(const LatticePoint& point) const;
};

/// \param winding  of the surface, or null if it is open; far points then stay unknown.
[[nodiscard]] SignedDistances fill_outside_band(SparseLattice distances, const FieldFrame& frame,
                                                const WindingScanlines* winding);

}  // namespace lefort::field
