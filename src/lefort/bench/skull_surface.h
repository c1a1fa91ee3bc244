/// \file
/// The skull surface of the benchmarks, as in Table 1 of the paper.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>

namespace lefort::bench {

/// Extraction of a skull of the size in the paper.
struct SkullSurfaceOptions {
  double bone_hu = 226.0;
  int smoothing_iterations = 20;  ///< Of the windowed sinc filter.
  double pass_band = 0.1;
  Index triangles = 96'190;  ///< As in the paper, section 3.2.1.
};

/// Flying edges at `bone_hu`, the largest connected component, windowed sinc smoothing,
/// Lindstrom-Turk edge collapse to exactly `triangles`.
///
/// Uses only VTK and CGAL, so that the surface does not depend on methods of lefort.
/// \returns the surface in L, closed; kMeshInvalid if the surface of the bone has fewer than
///   `triangles`, or if the simplification does not end at that number; kCancelled.
[[nodiscard]] Result<geometry::TriangleMesh> extract_skull(const image::CtVolume& ct,
                                                           const SkullSurfaceOptions& options = {},
                                                           Progress& progress = Progress::none());

}  // namespace lefort::bench
