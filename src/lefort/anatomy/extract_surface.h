/// \file
/// The zero surface of a level as a closed triangle mesh.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

struct IsosurfaceOptions {
  /// Closed parts, and closed cavities, that enclose less than this are left out; >= 0.
  double min_part_ml = 0.0;
};

/// Extracts the surface where a level (tissue_levels.h) is zero.
///
/// The vertices lie on the grid's edges, so a surface is free of self-intersections; nothing is
/// smoothed afterwards.
///
/// \param level    positive inside, finite, negative in its outermost voxels; any grid.
/// \param options  see IsosurfaceOptions.
/// \returns triangles in L, counter-clockwise seen from outside, closed, each vertex once, or
///   - kInvalidArgument  `level` is not finite, not negative all around, or contradicts its grid;
///   - kMeshInvalid      nothing is positive, or no part is large enough;
///   - kCancelled        `progress` asked to stop.
[[nodiscard]] Result<geometry::TriangleMesh> extract_isosurface(
    const image::ScalarVolume& level, const IsosurfaceOptions& options = {},
    Progress& progress = Progress::none());

}  // namespace lefort::anatomy
