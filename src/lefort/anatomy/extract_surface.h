/// \file
/// The zero surface of a level-set function as a closed triangle mesh.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// Options of extract_isosurface().
struct IsosurfaceOptions {
  /// Connected components, and closed cavities, that enclose less than this are dropped; >= 0.
  double min_part_ml = 0.0;
};

/// Extracts the surface where a level-set function (tissue_levels.h) is zero.
///
/// Vertices lie on grid edges, so a surface does not intersect itself. It is not smoothed.
///
/// \param level     positive inside, finite, negative in its outermost voxels; on any grid.
/// \param options   see IsosurfaceOptions.
/// \param progress  reports progress; may cancel.
/// \returns a closed surface in L, counter-clockwise seen from outside, without duplicate vertices,
///   or
///   - kInvalidArgument  `level` is not finite, is non-negative in an outermost voxel, does not
///     match its grid, or has fewer than 3 voxels along an axis; or an option is out of range;
///   - kMeshInvalid      nothing is positive, or no component is large enough;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<geometry::TriangleMesh> extract_isosurface(
    const image::ScalarVolume& level, const IsosurfaceOptions& options = {},
    Progress& progress = Progress::none());

}  // namespace lefort::anatomy
