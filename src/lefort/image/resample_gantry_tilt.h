/// \file
/// Parallel slices that do not lie evenly on top of each other, resampled to a regular grid.
#pragma once

#include <lefort/image/volume.h>

#include <cstdint>
#include <span>

namespace lefort::image {

/// The regular grid over a stack of slices: as wide as all of them, with the first slice's height
/// first and `count` slices `distance_mm` apart.
///
/// \param slice      one slice: size, spacing and direction along i and j; k is across.
/// \param origins_L  the center of the first pixel of each slice.
[[nodiscard]] Grid straight_grid(const Grid& slice, std::span<const Vec3> origins_L,
                                 double first_height_mm, double distance_mm, Index count);

/// The values of the slices on `grid`: within a slice by cubic convolution \cite keys1981, so that
/// thin bone keeps its density, from slice to slice linearly.
///
/// \param slices     their values one after another; the grid's directions and in-plane spacing are
///   those of straight_grid(), its origin and distance along k mean nothing.
/// \param origins_L  one for each slice, rising along the normal.
/// \param outside    what no slice shows.
/// \note Beyond the first and the last slice their values go on.
[[nodiscard]] CtVolume resample_gantry_tilt(const CtVolume& slices, std::span<const Vec3> origins_L,
                                            const Grid& grid, std::int16_t outside);

}  // namespace lefort::image
