/// \file
/// Checks a grid that was read from a file.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/volume.h>

namespace lefort::image {

/// Max voxels of a volume: 2^31, twice a cube of 1024.
inline constexpr Index kMaxVoxels = Index{1} << 31;

/// Checks that `grid` has 1 to kMaxVoxels voxels, spacings from 0.001 to 1000 mm, an origin within
/// 1e7 mm of 0 along each axis, and a direction that is a rotation within 1e-4 (files round it).
///
/// \param grid  as read from the file.
/// \returns nothing, or kFileCorrupt with a message that begins with "the grid has" and contains
///   the value, so that callers can prepend the name of the file.
[[nodiscard]] Result<void> check_grid(const Grid& grid);

}  // namespace lefort::image
