/// \file
/// Seeded watershed: assigns each voxel to one of several seeds.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// Grows all seeds in `room`, wide places before narrow ones, until all reachable voxels are
/// assigned: two seeds meet at the narrowest cross-section between them.
///
/// \param seeds          number of the seed at its voxels, 0 elsewhere.
/// \param room           where seeds may grow.
/// \param half_width_mm  priority of each voxel: half the local width, for example the distance of
///   the voxel to the walls of the room.
/// \returns the number of the seed of each voxel; 0 outside the room and where no seed can grow.
/// \note At equal widths the voxel that was reached first goes first, so the result is unique.
[[nodiscard]] image::Volume<std::int32_t> seeded_watershed(
    const image::Volume<std::int32_t>& seeds, const Mask& room,
    const image::ScalarVolume& half_width_mm);

}  // namespace lefort::anatomy
