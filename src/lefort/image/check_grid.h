/// \file
/// Whether a grid read from a file can be trusted to lie in the patient.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/volume.h>

namespace lefort::image {

/// The largest volume that is accepted: 2^31 voxels, twice a cube of 1024.
inline constexpr Index kMaxVoxels = Index{1} << 31;

/// Tells whether `grid` has at least one and at most kMaxVoxels voxels, spacings between 0.001 and
/// 1000 mm, a finite origin, and a direction that is a rotation to 1e-4 (files round it).
///
/// \returns nothing, or kFileCorrupt with a sentence that names the value; it speaks of "the grid",
///   so that callers can put the file's name before it.
[[nodiscard]] Result<void> check_grid(const Grid& grid);

}  // namespace lefort::image
