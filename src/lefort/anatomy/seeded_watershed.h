/// \file
/// A watershed from seeds: which of several rooms a voxel belongs to.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// Lets every seed grow through `room`, through wide places before narrow ones, until all that can
/// be reached is taken: two seeds meet at the narrowest place between them.
///
/// \param seeds     0 for no seed, otherwise a number that spreads; kept where it is.
/// \param room      where seeds may spread.
/// \param width_mm  half the width of the room at each voxel: its distance to the walls.
/// \returns the number of the seed that took the voxel; 0 outside the room and out of reach.
/// \note Of equal widths the earlier reached voxel goes first, so the result is unique.
[[nodiscard]] image::Volume<std::int32_t> seeded_watershed(const image::Volume<std::int32_t>& seeds,
                                                           const Mask& room,
                                                           const image::ScalarVolume& width_mm);

}  // namespace lefort::anatomy
