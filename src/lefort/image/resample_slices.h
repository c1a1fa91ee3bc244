/// \file
/// Resamples parallel slices that are shifted in their plane or unevenly spaced to a regular grid.
#pragma once

#include <lefort/image/volume.h>

#include <cstdint>
#include <span>

namespace lefort::image {

/// The regular grid that covers a stack of slices: wide enough for all of them.
///
/// \param slice            one slice: size, spacing and direction along i and j; k is the normal.
/// \param origins_L        center of the first pixel of each slice [mm].
/// \param first_height_mm  height of the first slice of the grid along the normal.
/// \param distance_mm      between slices of the grid.
/// \param count            number of slices of the grid.
[[nodiscard]] Grid regular_grid(const Grid& slice, std::span<const Vec3> origins_L,
                                double first_height_mm, double distance_mm, Index count);

/// The values of the slices on `grid`: within a slice by cubic convolution \cite keys1981, which
/// preserves the density of thin bone, between slices by linear interpolation.
///
/// \param slices     two or more, one after another. The directions and the in-plane spacing of
///   slices.grid are those of regular_grid(); its origin and spacing along k are not used.
/// \param origins_L  center of the first pixel of each slice [mm], ascending along the normal.
/// \param grid       from regular_grid().
/// \param outside    value of voxels that one of the two adjacent slices does not cover [HU].
/// \note Before the first and after the last slice the values of that slice are used. Values
///   are limited to -1024 to 3071 HU.
[[nodiscard]] CtVolume resample_slices(const CtVolume& slices, std::span<const Vec3> origins_L,
                                       const Grid& grid, std::int16_t outside);

}  // namespace lefort::image
