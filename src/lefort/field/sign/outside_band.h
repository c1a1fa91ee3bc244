/// \file
/// Zones of the space outside the band of a closed surface.
#pragma once

#include <lefort/field/sign/brick_signs.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::field {

/// Signs of all points of a brick: known points keep theirs, unsampled ones get the sign of the
/// winding number, so that wrong signs near self-intersections do not spread.
///
/// The diagonal of 4 x 4 x 4 points is 5.2 cells. If the band is at least half as wide, unsampled
/// points of such a block have the same sign, and eight evaluations are enough for a brick.
///
/// \param signs    of the known points.
/// \param winding  of the surface.
/// \param brick    number of the brick.
/// \param frame    lattice of the field.
[[nodiscard]] BrickBits inside_with_unsampled(const BrickSigns& signs,
                                              const WindingScanlines& winding, std::int32_t brick,
                                              const FieldFrame& frame);

/// Sets unsampled points (NaN) of a brick to +infinity outside the surface and -infinity inside it.
///
/// \param distances  of the points of the brick.
/// \param winding    of the surface.
/// \param brick      number of the brick.
/// \param frame      lattice of the field.
void fill_points_outside_band(std::span<float, SparseLattice::kBrickPoints> distances,
                              const WindingScanlines& winding, std::int32_t brick,
                              const FieldFrame& frame);

/// Zone of a brick without known points.
///
/// \param winding     of the surface.
/// \param brick       number of the brick.
/// \param resolution  of the lattice.
[[nodiscard]] Zone zone_of_empty_brick(const WindingScanlines& winding, std::int32_t brick,
                                       int resolution);

/// A signed distance for every lattice point; beyond the band +infinity outside the surface and
/// -infinity inside it, or NaN if the surface is open.
struct SignedDistances {
  SparseLattice near;
  std::vector<Zone> brick_zones;  ///< By brick number; valid for bricks that `near` does not have.

  [[nodiscard]] float at(const LatticePoint& point) const;
};

/// Completes the distances of a band.
///
/// \param distances  in the band.
/// \param frame      lattice of the field.
/// \param winding    of the surface, or null if it is open; then points outside the band remain
///   unknown.
[[nodiscard]] SignedDistances fill_outside_band(SparseLattice distances, const FieldFrame& frame,
                                                const WindingScanlines* winding);

}  // namespace lefort::field
