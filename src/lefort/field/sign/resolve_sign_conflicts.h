/// \file
/// What becomes of samples of a brick whose sides contradict each other.
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

/// Where a surface cuts through itself its nearest feature may tell the wrong side; how often it
/// winds around a point does not. So in a brick with contradictions, between known points or
/// between a known and a far one, all points further than a cell from the surface take the side of
/// their winding number.
///
/// \param distances  of the brick's points, NaN where not known.
/// \param signs      those of the distances.
/// \param inside     of all points, by inside_with_unsampled(); not looked at without a winding
///   number.
/// \param winding    of the surface, or null if it is open: nothing changes then.
/// \returns the points that contradict a neighbor in the brick still, some more than once.
std::vector<std::size_t> resolve_sign_conflicts(
    std::span<float, SparseLattice::kBrickPoints> distances, BrickSigns& signs,
    const BrickBits& inside, const WindingScanlines* winding, std::int32_t brick,
    const FieldFrame& frame);

}  // namespace lefort::field
