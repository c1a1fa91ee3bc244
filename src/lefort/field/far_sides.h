/// \file
/// Which side of a surface the space beyond the band is on.
#pragma once

#include <lefort/field/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <vector>

namespace lefort::field {

/// A signed distance for every point of the lattice: +-infinity far from the surface, by side, or
/// NaN where an open surface leaves the side unknown.
struct SidedDistances {
  SparseLattice near;
  std::vector<Zone> brick_sides;  ///< Of the bricks that `near` does not have, by brick number.

  [[nodiscard]] float at(const LatticePoint& point) const;
};

/// Fills in the points that are kFar.
///
/// Going along x from the rim of the lattice, which is outside, a far point has the side of the
/// point before it: a step of one cell cannot cross a surface that is further than a cell away.
/// This is the flood fill of empty space, row by row, and so in parallel.
///
/// \param closed  whether the surface encloses a volume; otherwise far points stay unknown.
[[nodiscard]] SidedDistances fill_far_sides(SparseLattice distances, bool closed);

}  // namespace lefort::field
