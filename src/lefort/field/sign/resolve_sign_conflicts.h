/// \file
/// Resolves sign conflicts in a brick with the winding number.
#pragma once

#include <lefort/field/field_frame.h>
#include <lefort/field/sign/brick_signs.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/sparse_lattice.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::field {

/// Where a surface intersects itself, the sign of the closest feature may be wrong, but the winding
/// number is right. In a brick with conflicts, between known points or between a known and an
/// unsampled one, all known points further than a cell from the surface get the sign of their
/// winding number.
///
/// \param distances  of the points of the brick, NaN where unknown.
/// \param signs      of `distances`.
/// \param inside     of all points, from inside_with_unsampled(); not used if `winding` is null.
/// \param winding    of the surface, or null if it is open: then nothing changes.
/// \param brick      number of the brick.
/// \param frame      lattice of the field.
/// \returns offsets of the points that are still in conflict with a neighbor in the brick; a point
///   may occur more than once.
std::vector<std::size_t> resolve_sign_conflicts(
    std::span<float, SparseLattice::kBrickPoints> distances, BrickSigns& signs,
    const BrickBits& inside, const WindingScanlines* winding, std::int32_t brick,
    const FieldFrame& frame);

}  // namespace lefort::field
